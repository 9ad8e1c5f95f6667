"""What is wrong with a whole recording: told where that is all that is left, and taken out."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from rthm_analysis.diagnosis.criteria.replay import BUDGET_STEPS
from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.faults.force_lag import ForceLag
from rthm_analysis.diagnosis.faults.leaks import Crosstalk, ForceLeak
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.deviating import deviation
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.budget import budget_for
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_core.spec import Spec, apply

from .faulty import PLAIN, having, plain
from .test_diagnosis_between import recorded, two_dofs

LAG = 0.05
UNSURE = apply(PLAIN, {"plant.stiffness": [12.5], "uncertainty.plant": {"damping": 0.3, "stiffness": 0.1}})


def found(evidence: Evidence, spec: Spec = UNSURE) -> Physical:
    return diagnose_physical(evidence, spec, np.empty(0), lambda said: None)


def lagging(evidence: Evidence) -> Evidence:
    """The same with the force as it was before the lag through which it acts."""
    force = CubicSpline(evidence.time, evidence.load)
    return replace(evidence, load=force(evidence.time) + LAG * force(evidence.time, 1))


@pytest.mark.long
def test_the_lag_of_a_force_is_told_and_taken_out() -> None:
    seen = lagging(plain())
    lag = deviation(found(seen))
    assert isinstance(lag, ForceLag) and lag.constant == pytest.approx(LAG, rel=0.02)

    mended = mend(seen, UNSURE).without(lag)
    (fault,) = mended.faults
    assert (fault.kind, fault.value) == ("force_lag", lag.constant)
    assert f"through a lag of first order of {1e3 * lag.constant:.3g} ms" in fault.words
    assert np.abs(mended.evidence.load - plain().load).max() < 2e-2 * np.abs(plain().load).max()
    again = found(mended.evidence)
    assert not again.selection.rounds and deviation(again) is None


@pytest.mark.parametrize(
    ("kind", "size"), [("quadratic_drag", {"coefficient": 2.0}), ("cubic_stiffness", {"coefficient": 200.0})]
)
def test_physics_is_no_lag(kind: str, size: dict[str, float]) -> None:
    assert deviation(found(plain(having(PLAIN, "plant", kind, **size)))) is None


SHARE = 0.2


def of_two_dofs() -> tuple[Spec, Evidence]:
    """A spec that is not quite sure, and a recording in which nothing is missing."""
    spec = two_dofs(mass=0.02, damping=0.3, stiffness=0.1)
    return spec, recorded(lambda x, v: (0.0, 0.0), duration=12.0)


def test_a_share_of_a_force_that_acts_on_another_dof_is_told_and_added(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    hardly_any = partial(budget_for, steps=0.02 * BUDGET_STEPS)  # the search before it finds nothing anyway
    monkeypatch.setattr("rthm_analysis.diagnosis.physical.side.budget_for", hardly_any)
    spec, acting = of_two_dofs()
    seen = replace(acting, load=acting.load - SHARE * np.outer(acting.load[:, 0], [0.0, 1.0]))
    leak = deviation(found(seen, spec))
    assert isinstance(leak, ForceLeak) and leak.pairs == ((0, 1), (1, 0))
    assert leak.numbers == pytest.approx([SHARE, 0.0], abs=0.01)

    mended = mend(seen, spec).without(leak)
    (fault,) = mended.faults
    assert (fault.kind, fault.value) == ("force_leak", leak.numbers[0])
    assert fault.words.startswith("20 % of the known force on x1 acts on x2, beside")
    assert np.abs(mended.evidence.load - acting.load).max() < 0.02 * np.abs(acting.load).max()


@pytest.mark.long
def test_a_sensor_that_reads_a_share_of_another_dof_is_told_and_put_right() -> None:
    spec, moved = of_two_dofs()
    share = np.zeros((4, 4))
    share[0, 1] = SHARE
    seen = replace(moved, measured=moved.measured @ (np.eye(4) + share))
    crosstalk = deviation(found(seen, spec))
    assert isinstance(crosstalk, Crosstalk)
    assert dict(zip(crosstalk.pairs, crosstalk.numbers, strict=True)) == pytest.approx(
        {(0, 1): SHARE, (1, 0): 0.0, (2, 3): 0.0, (3, 2): 0.0}, abs=0.01
    )

    mended = mend(seen, spec).without(crosstalk)
    (fault,) = mended.faults
    assert (fault.block, fault.kind, fault.channel) == ("sensor.position", "crosstalk", "x2.position")
    assert "20 % of the position of x1 is in the reading of the position of x2" in fault.words
    assert np.abs(mended.evidence.measured - moved.measured).max() < 0.01 * np.abs(moved.measured).max()
