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


def _plain_kinds() -> list[type[Effect]]:
    """Kinds of the plant that have a single number."""
    return [one for one in shipped("plant") if len(one.parameters) == 1 and not one.written]


def _kind_of(term: Term, at: Along, model: Model, law: type[Effect]) -> InitialGuess | None:
    """A kind with the size at which its force is that of a law; None where it has another shape, or sign."""
    (key,) = law.parameters
    unit = EffectInstance("plant", law.kind, term.dof, {key: 1.0})
    asked = InitialGuess(unit, (key,), (key,)).added_to(model)
    force = law_forces(asked, [len(asked.added) - 1], at.t, at.x, at.v, at.load)
    column = term.column(at)[:, 0]
    along = float(force @ column)
    if abs(along) < SAME_LAW_CORRELATION * np.linalg.norm(force) * np.linalg.norm(column) or along == 0.0:
        return None
    size = term.size * float(column @ column) / along
    low, high = unit.bounds(key, {key: size})
    one = EffectInstance("plant", law.kind, term.dof, {key: size})
    return InitialGuess(one, (key,), (key,), {key: abs(size)}) if low < size < high else None
