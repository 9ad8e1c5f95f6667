"""Above the noise a law is named where free curves over its own variables find little in what it leaves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.noise import white_noise
from rthm_analysis.diagnosis.missing.curves import CurveFit, Regression, free_curves
from rthm_analysis.diagnosis.missing.features import Curve, Feature
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.physical import above_noise
from rthm_analysis.diagnosis.physical.above_noise import Laws, least_gone, needed_only
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.search.judging import Selection
from rthm_core.spec import apply

from .plain import NOISE, plant, recorded

NOTHING = np.zeros(1)


@dataclass(frozen=True)
class Side:
    """What of a physical side matters here."""

    selection: Selection
    fitting: Any


AT = Along(NOTHING, NOTHING, NOTHING, NOTHING)


def curve(depends_on: str, share: float, held_out: float | None = None, **jump: float) -> CurveFit:
    """A free curve that explains so much of what is left; `change` and `std` are those of its jump, N."""
    sizes, stds = np.array([jump.get("change", 0.0)]), np.array([jump.get("std", 0.01)])
    held = share if held_out is None else held_out
    feature = Feature(tuple(depends_on), {}, ())
    return CurveFit("x1", feature, sizes, stds, share, 1.0, held, 1.0, AT, np.zeros((1, 0)), NOTHING[:0])


def model_with(**kinds: dict[str, float]) -> Any:
    added = tuple(EffectInstance("plant", kind, "x1", dict(values)) for kind, values in kinds.items())
    return SimpleNamespace(added=added, effect_values=lambda i: added[i].parameters)


def told(gone: float, curves: list[CurveFit], **kinds: dict[str, float]) -> bool:
    return Laws(model_with(**kinds), gone, curves).are_told


FRICTION = {"coulomb_friction": {"force": 2.0}}
OFFSET = {"constant_load": {"force": 0.4}}
CUBIC = {"cubic_stiffness": {"coefficient": 5.0}}


def test_friction_is_known_by_its_jump_whatever_else_depends_on_the_velocity() -> None:
    assert told(0.8, [curve("v", 0.9, change=0.3, std=0.1), curve("xv", 0.95)], **FRICTION)


@pytest.mark.parametrize("kinds", [FRICTION, FRICTION | OFFSET, CUBIC, OFFSET, FRICTION | CUBIC])
def test_what_removes_too_little_is_refused_whatever_curves_say(kinds: dict[str, dict[str, float]]) -> None:
    least, jump = least_gone(model_with(**kinds)), curve("v", 0.0, change=0.1, std=0.1)
    assert not told(least, [jump], **kinds)
    assert told(least + 0.01, [jump], **kinds)


@pytest.mark.parametrize("jump", [{"change": 1.9}, {"change": 0.3, "std": 1.0}, {"change": -1.2}])
def test_a_jump_that_a_free_curve_takes_away_or_does_not_tell_is_no_friction(jump: dict[str, float]) -> None:
    assert not told(0.97, [curve("v", 0.9, **jump)], **FRICTION)


def test_friction_that_changes_as_much_as_it_is_large_is_no_friction() -> None:
    some = {"gain": 400.0, "excess": 1e3, "held_out_gain": 400.0, "held_out_excess": 1e3}
    number = Feature(("v", "t"), {"v": NOTHING}, (Curve("1", "v", np.empty(0)),))
    changing = replace(curve("v", 0.4), feature=number, **some)
    small, large = (replace(changing, sizes=np.array([size])) for size in (0.5, 1.5))
    assert told(0.99, [curve("v", 0.0), small], **FRICTION)
    assert not told(0.99, [curve("v", 0.0), large], **FRICTION)


def test_a_constant_force_beside_friction_owes_more_than_friction_alone() -> None:
    curves = [curve("v", 0.8)]
    assert told(0.95, curves, **FRICTION, **OFFSET) and not told(0.85, curves, **FRICTION, **OFFSET)


def test_a_spring_is_whole_where_no_curve_over_the_position_finds_more() -> None:
    assert told(0.99, [curve("v", 0.9), curve("x", 0.1)], **CUBIC)
    assert not told(0.99, [curve("x", 0.9)], **CUBIC)
    assert not told(0.99, [curve("xv", 0.9)], **CUBIC)
    assert not told(0.97, [], **CUBIC)


def test_a_curve_that_unseen_data_deny_says_nothing() -> None:
    assert told(0.99, [curve("x", 0.9, -3.0), curve("x", -0.4, 0.9)], **CUBIC)


def test_a_constant_force_alone_is_whole_where_no_curve_finds_more() -> None:
    assert told(0.99, [curve("t", 0.2)], **OFFSET) and not told(0.99, [curve("t", 0.8)], **OFFSET)


def test_what_is_hardly_needed_beside_others_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    def fitted(error: float) -> Any:
        return SimpleNamespace(left_out=np.array([error]))

    without = {(1,): fitted(5e3), (0,): fitted(120.0)}
    monkeypatch.setattr(above_noise, "model_of", lambda selection, others: tuple(i for i, _ in others))
    fitting = SimpleNamespace(expected=50.0, fit=lambda model, most: without[model])
    rounds: Any = [[SimpleNamespace(label=("plant", kind, "x1"), start=None)] for kind in ("a", "b")]
    physical = Side(selection=Selection(fitted(1e4), fitted(100.0), rounds), fitting=fitting)
    kept, needless = needed_only(physical)  # type: ignore[arg-type]
    assert needless == (("plant", "b", "x1"),) and kept.selection.best is without[0,]


def test_curves_are_tried_with_forces_of_the_rigs_size_where_there_is_no_spring() -> None:
    spec = apply(plant(), {"plant.stiffness": [0.0]})
    evidence = recorded(lambda t, x, v: -0.1 * np.sign(v), stiffness=0.0)
    seen, train = evidence.first(evidence.stamps_ns.size), evidence.stamps_ns.size * 2 // 3
    start = np.arange(0, evidence.stamps_ns.size, 400)
    states = np.array([[*evidence.measured[i]] for i in start])
    experiment = Experiment(seen, np.empty(0))
    experiment.begin_at(seen.stamps_ns[start])
    windows = Windows(start, states, 2.0)
    noise = white_noise(np.array(NOISE))
    regression = Regression(experiment, windows, noise, Model(spec), train)
    assert 0.1 < regression.force_scale / np.std(evidence.load) < 10.0
    curves = free_curves(regression)
    over_v = next(one for one in curves if one.feature.depends_on == ("v",))
    assert min(over_v.share, over_v.held_out_share) > 0.9
    assert np.corrcoef(over_v.force, -np.sign(over_v.at.v))[0, 1] > 0.9
