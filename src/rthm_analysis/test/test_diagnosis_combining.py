"""What was found one by one is asked as a whole; a search ends when its work is done."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.sums import Sums
from rthm_analysis.diagnosis.replay.budget import Budget
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.choosing import choose
from rthm_analysis.diagnosis.search.combining import combined
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.tone_evidence import without_unproven_tones
from rthm_core.spec import Spec, apply

from .fittings import fitting_of
from .side import PAPER, having

CUBIC = InitialGuess(
    EffectInstance("plant", "cubic_stiffness", "x1", {"coefficient": 5.0}), ("coefficient",), ("coefficient",)
)
STRIBECK = InitialGuess(
    EffectInstance(
        "plant",
        "stribeck_friction",
        "x1",
        {"coulomb_force": 0.2, "static_force": 0.3, "stribeck_velocity": 0.5},
    ),
    ("coulomb_force", "static_force", "stribeck_velocity"),
    ("coulomb_force", "static_force"),
)
TONE = InitialGuess(
    EffectInstance("plant", "harmonic_load", "x1", {"amplitude": 0.3, "frequency": 9.0, "phase": 0.5}),
    ("amplitude", "frequency", "phase"),
    ("amplitude",),
)


def three(friction: float, drag: float, cubic: float) -> Spec:
    at = {"block": "plant", "dof": "x1"}
    return apply(
        having("plant", "coulomb_friction", force=friction),
        {
            "effects": ["one", "drag", "cubic"],
            "drag": at | {"kind": "quadratic_drag", "coefficient": drag},
            "cubic": at | {"kind": "cubic_stiffness", "coefficient": cubic},
        },
    )


def choice_of(fitting: Fitting, *starts: InitialGuess) -> Selection:
    selection = Selection(base := fitting.fit(Model(PAPER)), base)
    for start in starts:
        fitted = fitting.fit(start.added_to(selection.best.model), most=20)
        selection.rounds.append([FittedCandidate(start, fitted, float(fitted.left_out.sum()))])
        selection.best = fitted
    return selection


def test_a_ridge_is_left_for_the_better_side() -> None:
    fitting = fitting_of(three(0.3, 2.0, 20.0), 1)
    ridge = choice_of(fitting, CUBIC, STRIBECK)
    found = combined(fitting, ridge)
    assert {tried[0].label[1] for tried in found.rounds} == {
        "coulomb_friction",
        "quadratic_drag",
        "cubic_stiffness",
    }
    assert [tried[0].label[1] for tried in found.rounds] == [one.kind for one in found.best.model.added]
    force = next(
        found.best.model.effect_values(i)["force"]
        for i in range(3)
        if found.best.model.added[i].kind == "coulomb_friction"
    )
    assert isinstance(force, float) and force == pytest.approx(0.3, rel=0.05)
    assert found.best.squares < 1.1 * fitting.expected < ridge.best.squares


def test_a_combination_that_is_as_good_changes_nothing() -> None:
    fitting = fitting_of(having("plant", "cubic_stiffness", coefficient=20.0), 2)
    selection = choice_of(fitting, CUBIC)
    assert combined(fitting, selection) is selection


def test_a_search_whose_work_is_done_asks_no_more() -> None:
    fitting = fitting_of(three(0.3, 2.0, 20.0), 3)
    base = fitting.fit(Model(PAPER))
    assert fitting.budget.used > 0.0 and not fitting.budget.note
    fitting.budget.limit = fitting.budget.used * 0.5
    assert choose(fitting, base).rounds == []
    assert "before everything was tried" in fitting.budget.note


def test_a_fit_that_is_to_be_affordable_ends_with_the_step_that_spends_the_budget() -> None:
    fitting = fitting_of(three(0.3, 2.0, 20.0), 3)
    start = CUBIC.added_to(Model(PAPER))

    def work(most: int, affordable: bool) -> float:
        before = fitting.budget.used
        fitting.fit(start, most=most, affordable=affordable)
        return fitting.budget.used - before

    one_step, whole = work(1, False), work(20, False)
    assert work(20, True) == whole > one_step
    fitting.budget.limit = 0.0
    assert work(20, True) == one_step and work(20, False) == whole


def test_of_several_fits_a_few_are_begun_when_the_budget_is_spent() -> None:
    fitting, begun = fitting_of(three(0.3, 2.0, 20.0), 3), []

    def work(item: int) -> int:
        begun.append(item)
        fitting.budget.charge(1e6)
        return 2 * item

    assert fitting.each_affordable(work, range(9)) == [2 * item for item in range(9)]
    begun.clear()
    fitting.budget.limit = fitting.budget.used + 1e6
    assert fitting.each_affordable(work, range(9)) == [0, 2, 4, 6] and sorted(begun) == [0, 1, 2, 3]
    assert fitting.each_affordable(work, []) == []


def test_a_question_has_a_share_of_the_work_and_says_when_it_ended_early() -> None:
    budget = Budget()
    share = budget.share(1e6)
    assert not share.is_over and not budget.note
    budget.charge(2e6)
    assert share.is_over and not budget.spent and "before everything was tried" in budget.note
    assert not budget.share(1e6).is_over


def test_the_same_fit_is_the_same_work() -> None:
    used = set()
    for _ in range(2):
        fitting = fitting_of(three(0.3, 2.0, 20.0), 4)
        choice_of(fitting, CUBIC)
        used.add(fitting.budget.used)
    assert len(used) == 1


def toned(fitting: Fitting, share: float) -> FittedCandidate:
    """A tone that lasts for a part of the recording only, fitted as if it lasted."""
    model = TONE.added_to(Model(PAPER))
    count, rng = 4000, np.random.default_rng(1)
    phase = np.arange(count) * 0.05
    lasts = np.where(np.arange(count) < share * count, 1.0, 0.0)
    columns = np.stack([10.0 * np.sin(phase), np.zeros(count), 3.0 * np.cos(phase)])
    residual = rng.normal(size=count) + (lasts - share) * 3.0 * np.sin(phase)
    parts = np.array_split(np.arange(count), 20)
    sums = Sums(
        np.stack([columns[:, p] @ columns[:, p].T for p in parts]),
        np.stack([columns[:, p] @ residual[p] for p in parts]),
        np.array([residual[p] @ residual[p] for p in parts]),
        np.zeros(3),
        np.zeros(3),
    )
    fitting.expected = float(count)
    return FittedCandidate(TONE, Fitted(model, 0.0, sums, count), 0.0)


@pytest.mark.parametrize(("share", "kept"), [(1.0, 1), (0.4, 0)])
def test_a_tone_that_does_not_last_is_none(share: float, kept: int) -> None:
    fitting = fitting_of(PAPER, 5)
    base = fitting.fit(Model(PAPER))
    assert len(without_unproven_tones(fitting, [toned(fitting, share)], base)) == kept


def test_a_kind_that_does_nearly_as_well_is_named_before_a_tone() -> None:
    fitting = fitting_of(PAPER, 6)
    base = fitting.fit(Model(PAPER))
    tone, before = toned(fitting, 1.0), float(base.left_out.sum())
    near, far = (FittedCandidate(CUBIC, base, error) for error in (0.3 * before, 0.9 * before))
    assert without_unproven_tones(fitting, [tone, near], base) == [near, tone]
    assert without_unproven_tones(fitting, [tone, far], base) == [tone, far]
