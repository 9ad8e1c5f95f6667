"""Beside a formula a kind is told only where the data miss it, and not what a slightly other formula does."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical.beginning import begin
from rthm_analysis.diagnosis.physical.composing import with_formulas
from rthm_analysis.diagnosis.physical.fewer import judged_of
from rthm_analysis.diagnosis.physical.fewer_kinds import is_beyond_chance, with_fewer_kinds
from rthm_analysis.diagnosis.physical.formula_model import with_all
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.budget import budget_for
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection
from rthm_analysis.diagnosis.search.starts import InitialGuess

from .plain import plant, recorded

GROWTH, CREEP = 1.0, 0.1
"""Of friction: with the way, N/m, and the speed below which it creeps, m/s."""


def physical_of(spring: float) -> Physical:
    """A recording of friction that grows with the way, and of a cubic spring, with nothing found yet."""

    def law(t: float, x: float, v: float) -> float:
        return -(0.05 + GROWTH * abs(x)) * np.tanh(v / CREEP) - spring * x**3

    seen, spec, nothing = recorded(law), plant(), np.empty(0)
    budget = budget_for(seen.stamps_ns.size)
    begun = begin(seen, Model(spec), nothing, budget, lambda said: None)[0]
    whole = Experiment(seen, nothing, seen=seen.trained)
    whole.begin_at(seen.stamps_ns[begun.runs.start])
    return Physical(
        spec, seen, seen.trained, whole, begun.runs, begun.noise, [], spec, begun.fitting, begun.nominal,
        Selection(begun.retuned, begun.retuned), {}, np.empty((seen.trained, 0)), nothing, False,
    )  # fmt: skip


def guess(kind: str, formula: str | None = None, **numbers: float) -> InitialGuess:
    text = {} if formula is None else {"force": formula}
    added = EffectInstance("plant", kind, "x1", text | numbers)
    first = next(iter(numbers))
    return InitialGuess(added, tuple(numbers), (first,), {name: abs(one) for name, one in numbers.items()})


def kinds_told(spring: float, formula: InitialGuess) -> list[str]:
    physical = physical_of(spring)
    judged, base = judged_of(physical), physical.selection.base
    cubic = guess("cubic_stiffness", coefficient=5.0)
    rounds = [[FittedCandidate(cubic, base, float(base.left_out.sum()))]]
    both = with_formulas(judged, base, with_all(base.model, [cubic, formula]), [formula], rounds)
    assert both is not None and both.earned
    return [tried[0].label[1] for tried in with_fewer_kinds(both).physical.selection.rounds]


RIGHT = guess("formula", "(a + b * abs(x)) * tanh(v / c)", a=-0.06, b=-0.9, c=0.12)
NEARLY = guess("formula", "a * tanh(v / b) * abs(x)**c", a=-0.5, b=0.12, c=0.6)


@pytest.mark.parametrize("formula", [RIGHT, NEARLY], ids=["right", "nearly"])
def test_what_a_formula_can_be_bent_to_do_is_no_kind(formula: InitialGuess) -> None:
    assert kinds_told(0.0, formula) == ["formula"]


def test_a_spring_that_the_data_miss_is_told_beside_a_formula() -> None:
    assert kinds_told(60.0, RIGHT) == ["cubic_stiffness", "formula"]


def test_chance_is_larger_where_more_than_noise_is_left() -> None:
    assert is_beyond_chance(30.0, 10.0, 1, 1.0)
    assert not is_beyond_chance(30.0, 10.0, 1, 3.0)
    assert not is_beyond_chance(30.0, 1.0, 1, 1.0) and not is_beyond_chance(10.0, 10.0, 1, 1.0)
    assert not is_beyond_chance(18.0, 10.0, 3, 1.0)
