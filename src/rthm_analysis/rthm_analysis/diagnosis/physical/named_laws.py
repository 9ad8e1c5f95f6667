"""Plain laws by their names: the kind of the library whose force is the same, or a formula."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    NEARLY_SAME_LAW_CORRELATION,
    PLAIN_LAWS_ALIKE,
    SAME_LAW_CORRELATION,
)
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.physical.formula_model import guess_of
from rthm_analysis.diagnosis.physical.work import law_forces
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.compiled import Floats
from rthm_core.effects.declaration import Effect
from rthm_core.effects.formula import NUMBERS
from rthm_core.effects.registry import shipped
from rthm_core.spec.effect import place_keys


def guesses_of(regression: Regression, model: Model, terms: Iterable[Term]) -> list[InitialGuess]:
    """Where fits of some plain laws begin beside a model: kinds of the library first, then formulas."""
    found = []
    for term in terms:
        at = regression.along(regression.site(term.site))
        force = term.site, term.size * term.column(at)[:, 0]
        kinds = (_kind_of(force, at, model, law) for law in _plain_kinds(term.site))
        found.append(next(filter(None, kinds), None) or guess_of(term))
    return sorted(found, key=lambda one: one.added.law.written)


def without_repeated(regression: Regression, model: Model, terms: Iterable[Term]) -> tuple[Term, ...]:
    """The terms but those that are the law of a kind which a model has already: both would only cancel."""
    return tuple(one for one in terms if not _repeats(regression, model, one))


def kind_as(model: Model, index: int, at: Along) -> InitialGuess | None:
    """The kind of the library whose force is nearly that of a formula which a model adds to a dof, along its
    motion; None where there is none.

    A formula with a number within it was fitted to be no kind; ``a (x - sin x)`` is one in small motions.
    """
    dof, numbers = model.added[index].place, model.added[index].parameters.keys() & {*NUMBERS}
    alike = PLAIN_LAWS_ALIKE if len(numbers) == 1 else NEARLY_SAME_LAW_CORRELATION
    force = law_forces(model, [index], at.t, at.x, at.v, at.load)
    kinds = (_kind_of((dof, force), at, model, law, alike) for law in _plain_kinds(dof))
    return next(filter(None, kinds), None)


def _repeats(regression: Regression, model: Model, term: Term) -> bool:
    at = regression.along(regression.site(term.site))
    there = {one.kind for one in model.added if one.block == "plant" and one.place == term.site}
    laws = (law for law in _plain_kinds(term.site) if law.kind in there)
    return any(_number((term.site, term.column(at)[:, 0]), at, model, law) is not None for law in laws)


def _plain_kinds(place: str) -> list[type[Effect]]:
    """Kinds that have a single number and may be at a place."""
    some = (one for one in shipped("plant") if len(one.parameters) == 1 and not one.written)
    return [one for one in some if one.between_dofs or place_keys(place)[1] is None]


def _kind_of(
    force: tuple[str, Floats], at: Along, model: Model, law: type[Effect], alike: float = SAME_LAW_CORRELATION
) -> InitialGuess | None:
    """A kind with the number at which it is a force (s,) on a dof; None if its shape, or sign, is another."""
    (key,), number = law.parameters, _number(force, at, model, law, alike)
    if number is None:
        return None
    one = EffectInstance("plant", law.kind, force[0], {key: number})
    low, high = one.bounds(key, {key: number})
    return InitialGuess(one, (key,), (key,), {key: abs(number)}) if low < number < high else None


def _number(
    force: tuple[str, Floats], at: Along, model: Model, law: type[Effect], alike: float = SAME_LAW_CORRELATION
) -> float | None:
    """Number of a kind for a force (s,) on a dof; None where they are not one law along the recording."""
    (key,), (dof, asked) = law.parameters, force
    unit = InitialGuess(EffectInstance("plant", law.kind, dof, {key: 1.0}), (key,), (key,))
    with_unit = unit.added_to(model)
    of_unit = law_forces(with_unit, [len(with_unit.added) - 1], at.t, at.x, at.v, at.load)
    along = float(of_unit @ asked)
    is_alike = abs(along) >= alike * np.linalg.norm(of_unit) * np.linalg.norm(asked)
    return float(asked @ asked) / along if along and is_alike else None
