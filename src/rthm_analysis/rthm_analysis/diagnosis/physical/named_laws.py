"""Plain laws by their names: the kind of the library whose force is the same, or a formula."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import SAME_LAW_CORRELATION
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.physical.formula_model import guess_of
from rthm_analysis.diagnosis.physical.work import law_forces
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.declaration import Effect
from rthm_core.effects.registry import shipped


def guesses_of(regression: Regression, model: Model, terms: Iterable[Term]) -> list[InitialGuess]:
    """Where fits of some plain laws begin beside a model: kinds of the library first, then formulas."""
    found = []
    for term in terms:
        at = regression.along(regression.dof(term.dof))
        kinds = (_kind_of(term, at, model, law) for law in _plain_kinds())
        found.append(next(filter(None, kinds), None) or guess_of(term))
    return sorted(found, key=lambda one: one.added.law.written)


def without_repeated(regression: Regression, model: Model, terms: Iterable[Term]) -> tuple[Term, ...]:
    """The terms but those that are the law of a kind which a model has already: both would only cancel."""
    return tuple(one for one in terms if not _repeats(regression, model, one))


def _repeats(regression: Regression, model: Model, term: Term) -> bool:
    at = regression.along(regression.dof(term.dof))
    there = {one.kind for one in model.added if one.block == "plant" and one.place == term.dof}
    laws = (law for law in _plain_kinds() if law.kind in there)
    return any(_ratio(term, at, model, law) is not None for law in laws)


def _plain_kinds() -> list[type[Effect]]:
    """Kinds of the plant that have a single number."""
    return [one for one in shipped("plant") if len(one.parameters) == 1 and not one.written]


def _kind_of(term: Term, at: Along, model: Model, law: type[Effect]) -> InitialGuess | None:
    """A kind with the size at which its force is that of a law; None where it has another shape, or sign."""
    (key,), ratio = law.parameters, _ratio(term, at, model, law)
    if ratio is None:
        return None
    size = ratio * term.size
    one = EffectInstance("plant", law.kind, term.dof, {key: size})
    low, high = one.bounds(key, {key: size})
    return InitialGuess(one, (key,), (key,), {key: abs(size)}) if low < size < high else None


def _ratio(term: Term, at: Along, model: Model, law: type[Effect]) -> float | None:
    """Number of a kind for a term of size 1; None where their forces are not one law along the recording."""
    (key,) = law.parameters
    unit = InitialGuess(EffectInstance("plant", law.kind, term.dof, {key: 1.0}), (key,), (key,))
    asked = unit.added_to(model)
    force = law_forces(asked, [len(asked.added) - 1], at.t, at.x, at.v, at.load)
    column = term.column(at)[:, 0]
    along = float(force @ column)
    alike = abs(along) >= SAME_LAW_CORRELATION * np.linalg.norm(force) * np.linalg.norm(column)
    return float(column @ column) / along if along and alike else None
