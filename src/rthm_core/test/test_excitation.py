"""The motion that measures a rig."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_core.errors import InputError
from rthm_core.excitation import QUIET_START, SWELL, excitation
from rthm_core.spec import shipped_spec

PAPER = shipped_spec()


def test_motors_stand_still_at_first_and_then_move_within_the_travel() -> None:
    motion = excitation(PAPER, 0.01)
    times = np.arange(0.0, 10.0, 0.004)
    u = np.array([motion.at(float(t)) for t in times])
    assert np.all(u[times <= QUIET_START] == 0.0)
    assert 0.008 < np.abs(u[times > QUIET_START + SWELL]).max() <= 0.01
    assert np.abs(np.diff(u, axis=0)).max() < 0.01


def test_speeds_are_equal_at_all_frequencies() -> None:
    motion = excitation(PAPER, 0.01)
    speeds = motion.amplitude * motion.frequency
    np.testing.assert_allclose(speeds, speeds[0, 0], rtol=1e-12)
    assert motion.frequency[-1] < np.pi / PAPER.loop().timing.td3


@pytest.mark.parametrize("travel", [0.0, -0.1, float("nan"), float("inf")])
def test_a_travel_that_is_none_is_refused(travel: float) -> None:
    with pytest.raises(InputError, match="but must be a distance above 0 m"):
        excitation(PAPER, travel)
