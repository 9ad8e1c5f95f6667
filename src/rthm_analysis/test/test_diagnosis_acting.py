"""Forces that act in an interval alone, and forces so large that the model is lost without them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.acting import acting
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_core.spec import Spec, apply

from .plain import plant, recorded


def physical_of(seen: Evidence, spec: Spec) -> Physical:
    return diagnose_physical(seen, spec, np.empty(0), lambda said: None)


@pytest.mark.parametrize(
    ("begin", "end"),
    [
        pytest.param(6.0, 11.0, id="comes and goes"),
        pytest.param(9.0, 24.0, id="stays", marks=pytest.mark.long),
    ],
)
def test_a_cable_that_catches_for_a_while_is_told_with_its_interval(begin: float, end: float) -> None:
    seen = recorded(lambda t, x, v: -20.0 * max(x - 0.005, 0.0) if begin < t < end else 0.0)
    physical = physical_of(seen, plant())
    found = acting(physical, seen.time.size)
    assert found is not None and found.interval == pytest.approx((begin, end), abs=2.0)
    part = physical_part(physical)
    (one,) = part.described
    assert not part.physics and set(one.depends_on) == {"x", "t"}
    assert one.interval == pytest.approx((begin, end), abs=1.0)
    unconfirmed = "acts before the unseen data begin" in one.words
    assert unconfirmed == (end < seen.time[physical.train])


def test_nothing_acts_in_an_interval_where_nothing_is_missing_or_something_always_is() -> None:
    for law in (lambda t, x, v: 0.0, lambda t, x, v: -2.0 * math.tanh(x / 0.05)):
        physical = physical_of(recorded(law), plant())
        assert acting(physical, physical.evidence.time.size) is None


def swinging(start: float, seed: int = 0) -> Evidence:
    """A pendulum with dry friction that swings freely; its velocity is not measured."""

    def law(t: float, x: float, v: float) -> float:
        return 12.0 * (x - math.sin(x)) - 0.03 * math.tanh(v / 1e-3)

    seen = recorded(law, duration=40.0, force=0.0, start=start, seed=seed)
    return replace(seen, channels=seen.channels[:1], measured=seen.measured[:, :1])


@pytest.mark.long
def test_a_pendulum_that_swings_far_is_told_as_one() -> None:
    part = physical_part(physical_of(swinging(1.5), plant(start=1.5, stiffness=0.03, damping=0.5)))
    formulas = [str(one["force"]) for one in part.effects if one["kind"] == "formula"]
    assert "a * (x - sin(x))" in formulas
    (swing,) = (one for one in part.effects if one.get("force") == "a * (x - sin(x))")
    assert swing["a"] == pytest.approx(12.0, rel=0.02)  # type: ignore[comparison-overlap]
    fits = {fit.signal: fit.nrmse for fit in part.fits}
    assert fits["x1"]["explained"] < 0.1 * fits["x1"]["retuned"]


def test_effects_are_added_behind_those_that_an_earlier_diagnosis_found() -> None:
    friction = {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.1}
    patched = apply(plant(), {"effects": ["found1"], "found1": friction})
    added = EffectInstance("plant", "coulomb_friction", "x1", {"force": 2.0})
    model = Model(patched).plus(added, ("force",), {})
    assert [one.name for one in model.spec.effects] == ["found1", "found2"]
    assert model.effect_values(0) == {"force": 2.0}
