"""A known force that acts through a lag: told where that is all that is missing, and taken out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.lagging_force import lagging_force
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_core.spec import apply

from .faulty import PLAIN, having, plain

LAG = 0.05
UNSURE = apply(PLAIN, {"plant.stiffness": [12.5], "uncertainty.plant": {"damping": 0.3, "stiffness": 0.1}})


def found(evidence: Evidence) -> Physical:
    return diagnose_physical(evidence, UNSURE, np.empty(0), lambda said: None)


def lagging(evidence: Evidence) -> Evidence:
    """The same with the force as it was before the lag through which it acts."""
    force = CubicSpline(evidence.time, evidence.load)
    return replace(evidence, load=force(evidence.time) + LAG * force(evidence.time, 1))


def test_the_lag_of_a_force_is_told_and_taken_out() -> None:
    seen = lagging(plain())
    lag = lagging_force(found(seen))
    assert lag is not None and lag.constant == pytest.approx(LAG, rel=0.02)

    mended = mend(seen, UNSURE).in_step(lag)
    (fault,) = mended.faults
    assert (fault.kind, fault.value) == ("force_lag", lag.constant)
    assert f"through a lag of first order of {1e3 * lag.constant:.3g} ms" in fault.words
    assert np.abs(mended.evidence.load - plain().load).max() < 2e-2 * np.abs(plain().load).max()
    again = found(mended.evidence)
    assert not again.selection.rounds and lagging_force(again) is None


@pytest.mark.parametrize(
    ("kind", "size"), [("quadratic_drag", {"coefficient": 2.0}), ("cubic_stiffness", {"coefficient": 200.0})]
)
def test_physics_is_no_lag(kind: str, size: dict[str, float]) -> None:
    assert lagging_force(found(plain(having(PLAIN, "plant", kind, **size)))) is None
