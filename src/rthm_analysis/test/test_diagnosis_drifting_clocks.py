"""A known force and a motion that two clocks recorded: they drift apart, and are brought together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.drifting_clocks import drifting_clocks
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_core.spec import apply

from .faulty import PLAIN, having, plain

DRIFT = 1.5e-3


def found(evidence: Evidence) -> Physical:
    return diagnose_physical(evidence, PLAIN, np.empty(0), lambda said: None)


def drifting(evidence: Evidence) -> Evidence:
    """The same with a known force that was recorded by a clock that runs slow."""
    load = CubicSpline(evidence.time, evidence.load)(evidence.time * (1.0 + DRIFT))
    return replace(evidence, load=load)


def test_clocks_that_drift_apart_are_told_and_brought_together() -> None:
    late = drifting(plain())
    drift = drifting_clocks(found(late))
    assert drift is not None and drift.growth == pytest.approx(DRIFT, rel=0.02)

    mended = mend(late, PLAIN).without(drift)
    (fault,) = mended.faults
    assert (fault.kind, fault.value) == ("clock_drift", drift.growth)
    assert "later and later after the known force, by 1" in fault.words
    assert not found(mended.evidence).selection.rounds


@pytest.mark.parametrize(
    ("kind", "size"), [("quadratic_drag", {"coefficient": 2.0}), ("cubic_stiffness", {"coefficient": 200.0})]
)
def test_physics_is_no_drift(kind: str, size: dict[str, float]) -> None:
    assert drifting_clocks(found(plain(having(PLAIN, "plant", kind, **size)))) is None


@pytest.mark.long
def test_clocks_that_drift_are_found_where_values_are_uncertain_too() -> None:
    """A retuned model makes up for some of the drift: values and drift are found together."""
    stated = {"uncertainty.plant": {"damping": 0.3, "stiffness": 0.1}}
    unsure = apply(PLAIN, {"plant.stiffness": [12.5]} | stated)
    late = drifting(plain())
    drift = drifting_clocks(diagnose_physical(late, unsure, np.empty(0), lambda said: None))
    assert drift is not None and drift.growth == pytest.approx(DRIFT, rel=0.05)


def test_one_clock_has_no_drift() -> None:
    assert drifting_clocks(found(plain())) is None
