"""A sensor that is not linear is told as one: its error shows in its own signal alone, over its reading."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.faults.bend import bend_of, curve_share, share_of
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.bent_sensors import bent_sensors
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.compiled import Floats

from .faulty import PLAIN, POSITION, changed, having, plain

VALUES = np.random.default_rng(3).normal(scale=0.02, size=6000)


def found(evidence: Evidence) -> Physical:
    return diagnose_physical(evidence, PLAIN, np.empty(0), lambda said: None)


def squared(x: Floats) -> Floats:
    return np.asarray(x + 0.3 * x**2)


def eccentric(x: Floats) -> Floats:
    return np.asarray(x + 1e-3 * np.sin(2.0 * np.pi * x / 0.03))


@pytest.mark.parametrize("reads", [squared, eccentric])
def test_a_sensor_that_is_not_linear_is_told_and_straightened(reads) -> None:  # type: ignore[no-untyped-def]
    true = plain()
    bent = changed(true, POSITION, reads)

    (one,) = bent_sensors(found(bent))
    assert one.channel == Channel("position", "x1") and one.is_clear

    mended = mend(bent, PLAIN).straightened({one.channel: one.bend})
    (fault,) = mended.faults
    assert (fault.block, fault.kind, fault.channel) == ("sensor.position", "nonlinear", "x1.position")
    error = np.abs(reads(true.measured[:, 0]) - true.measured[:, 0]).max()
    assert fault.value == pytest.approx(error, rel=0.15)
    left = mended.evidence.measured[:, 0] - true.measured[:, 0]
    assert np.nanstd(left) < 0.05 * error
    assert not found(mended.evidence).selection.rounds


def test_springs_are_no_error_of_a_sensor() -> None:
    spring = having(PLAIN, "plant", "cubic_stiffness", coefficient=200.0)
    assert not bent_sensors(found(plain(spring)))


def test_an_error_that_repeats_is_told_with_its_period() -> None:
    bend = bend_of(VALUES, 1e-3 * np.sin(2.0 * np.pi * VALUES / 0.011 + 0.4))
    assert bend.period == pytest.approx(0.011, rel=1e-3)


def test_an_offset_and_a_gain_have_no_share() -> None:
    line = 0.02 + 0.1 * VALUES
    bend = bend_of(VALUES, line + 0.5 * VALUES**2)
    assert bend.period is None
    assert bend.error(VALUES) == pytest.approx(line + 0.5 * VALUES**2, abs=1e-9)
    noise = 1e-4 * np.random.default_rng(4).normal(size=VALUES.size)
    assert share_of(bend_of(VALUES, line + noise), VALUES, line + noise) < 0.02


def test_beyond_the_range_nothing_is_known() -> None:
    bend = bend_of(VALUES, VALUES**2)
    assert np.isnan(bend.true(np.array([1.2 * VALUES.max()]))).all()


def test_noise_has_no_curve() -> None:
    noise = np.random.default_rng(4).normal(size=VALUES.size)
    assert curve_share(VALUES, noise) < 0.1
    assert share_of(bend_of(VALUES, noise), VALUES, noise) < 0.02
