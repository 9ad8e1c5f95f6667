"""Other kinds in the place of an effect that was chosen."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection, distinguishable
from rthm_analysis.diagnosis.search.replacing import compared, or_twin, plainer, rounds_refitted
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.spec import Spec, apply

from .fittings import fitting_of
from .side import PAPER, having

COULOMB = InitialGuess(
    EffectInstance("plant", "coulomb_friction", "x1", {"force": 0.2}), ("force",), ("force",)
)
STRIBECK = InitialGuess(
    EffectInstance(
        "plant",
        "stribeck_friction",
        "x1",
        {"coulomb_force": 0.2, "static_force": 0.4, "stribeck_velocity": 0.05},
    ),
    ("coulomb_force", "static_force", "stribeck_velocity"),
    ("coulomb_force", "static_force"),
)
CUBIC = InitialGuess(
    EffectInstance("plant", "cubic_stiffness", "x1", {"coefficient": 5.0}), ("coefficient",), ("coefficient",)
)
DRAG = InitialGuess(
    EffectInstance("plant", "quadratic_drag", "x1", {"coefficient": 0.5}), ("coefficient",), ("coefficient",)
)

RESONATOR = InitialGuess(
    EffectInstance("plant", "hidden_mode", "x1", {"mass": 0.05, "frequency": 3.9, "damping_ratio": 0.05}),
    ("mass", "frequency", "damping_ratio"),
    ("mass",),
)
WAVES = InitialGuess(
    EffectInstance("plant", "fluid_memory", "x1", {"gain": 0.8, "frequency": 3.9, "damping_ratio": 0.05}),
    ("gain", "frequency", "damping_ratio"),
    ("gain",),
)

RUBBED = having("plant", "coulomb_friction", force=0.3)
FALLING = having("plant", "stribeck_friction", coulomb_force=0.2, static_force=0.4, stribeck_velocity=0.05)


def tried(fitting: Fitting, start: InitialGuess, before: Fitted) -> FittedCandidate:
    fitted = fitting.fit(start.added_to(before.model))
    return FittedCandidate(start, fitted, float(fitted.left_out.sum()))


def choice_of(fitting: Fitting, *rounds: tuple[InitialGuess, ...]) -> Selection:
    """Rounds whose first kind was chosen, each fitted on what was chosen before it."""
    selection = Selection(base := fitting.fit(Model(PAPER)), base)
    for starts in rounds:
        selection.rounds.append([tried(fitting, start, selection.best) for start in starts])
        selection.best = selection.rounds[-1][0].fitted
    return selection


def kinds(selection: Selection) -> list[str]:
    assert [one.kind for one in selection.best.model.added] == [one[0].label[1] for one in selection.rounds]
    return [one.kind for one in selection.best.model.added]


@pytest.mark.parametrize(("true", "kind"), [(RUBBED, "coulomb_friction"), (FALLING, "stribeck_friction")])
def test_a_kind_gives_way_to_the_plainer_one_in_it_unless_it_is_needed(true: Spec, kind: str) -> None:
    fitting = fitting_of(true, 1)
    assert kinds(plainer(fitting, choice_of(fitting, (STRIBECK,)))) == [kind]


RESONATING = having("plant", "hidden_mode", mass=0.06, frequency=4.0, damping_ratio=0.04)
RADIATING = having("plant", "fluid_memory", gain=0.9, frequency=4.0, damping_ratio=0.04)


@pytest.mark.parametrize("chosen", [RESONATOR, WAVES])
@pytest.mark.parametrize(("true", "kind"), [(RESONATING, "hidden_mode"), (RADIATING, "fluid_memory")])
def test_of_two_kinds_of_nearly_the_same_force_the_one_that_predicts_best_is_named(
    true: Spec, kind: str, chosen: InitialGuess
) -> None:
    fitting = fitting_of(true, 4)
    found = or_twin(fitting, choice_of(fitting, (chosen,)))
    assert kinds(found) == [kind]
    assert {one.label[1] for one in found.rounds[0]} == {"hidden_mode", "fluid_memory"}
    frequency = found.best.model.effect_values(0)["frequency"]
    assert isinstance(frequency, float) and abs(frequency - 4.0) < 0.02


def with_cubic(true: Spec) -> Spec:
    cubic = {"block": "plant", "kind": "cubic_stiffness", "dof": "x1", "coefficient": 20.0}
    return apply(true, {"effects": ["one", "cubic"], "cubic": cubic})


def test_kinds_of_an_early_round_are_told_apart_once_the_rest_is_known() -> None:
    fitting = fitting_of(with_cubic(RUBBED), 2)
    selection = choice_of(fitting, (COULOMB, DRAG), (CUBIC,))
    found = compared(fitting, selection)
    assert kinds(found) == ["coulomb_friction", "cubic_stiffness"]
    assert distinguishable(found.best, found.rounds[0][1].fitted)


def test_a_kind_that_was_chosen_too_early_gives_way() -> None:
    fitting = fitting_of(with_cubic(RUBBED), 3)
    found = compared(fitting, choice_of(fitting, (DRAG, COULOMB), (CUBIC,)))
    assert kinds(found) == ["coulomb_friction", "cubic_stiffness"]
    force = found.best.model.effect_values(0)["force"]
    assert isinstance(force, float) and abs(force - 0.3) < 0.01


def test_a_round_that_cannot_be_fitted_without_the_next_keeps_its_fit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fitting = fitting_of(with_cubic(RUBBED), 2)
    selection = choice_of(fitting, (COULOMB,), (CUBIC,))

    def diverges(self: Fitting, model: Model) -> Fitted:
        raise np.linalg.LinAlgError("a model has no finite sensitivities")

    monkeypatch.setattr(Fitting, "fit", diverges)
    assert rounds_refitted(fitting, selection).rounds == selection.rounds
