"""Terms of a formula as effects of a model."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import FORMULA_FIT_STEPS, INSTANT_SAMPLES, INSTANT_TRIALS
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.formula import NUMBERS, Formula

INSTANT = re.compile(r"\((\w) < t\)|\(t < (\w)\)")
"""An instant at which a term begins, or ends."""


def with_terms(model: Model, terms: Iterable[Term]) -> Model:
    """A model with some terms beside its effects."""
    for one in terms:
        model = _guess(one).added_to(model)
    return model


def fit_terms(fitting: Fitting, model: Model) -> Fitted | None:
    """Fit of a model with terms; None where it diverges.

    Between two steps of a replay an instant at which a term begins or ends changes nothing, so no slope leads
    to it: it is looked for by itself, among the samples around it.
    """
    try:
        fitting.rebase(model)  # a force that was missing changes how initial states show
        fitted = fitting.fit(model, most=FORMULA_FIT_STEPS)
        for key in _instants(fitted.model):
            moved = _moved(fitting, fitted.model, key)
            fitted = fitting.fit(moved, most=FORMULA_FIT_STEPS) if moved is not fitted.model else fitted
    except np.linalg.LinAlgError:
        return None
    return fitted


def _instants(model: Model) -> list[str]:
    """Keys of the instants at which terms of a model begin or end."""
    found = []
    for index, one in enumerate(model.added):
        text = str(one.parameters.get("force", ""))
        found += [f"{model.name(index)}.{first or last}" for first, last in INSTANT.findall(text)]
    return found


def _moved(fitting: Fitting, model: Model, key: str) -> Model:
    """The model with an instant where it leaves least."""
    from scipy.optimize import minimize_scalar

    index = [p.key for p in model.parameters].index(key)
    values, step = model.values, float(np.median(np.diff(fitting.experiment.evidence.time)))

    def at(instant: float) -> Model:
        return model.at(np.concatenate([values[:index], [instant], values[index + 1 :]]))

    reach = INSTANT_SAMPLES * step
    found = minimize_scalar(
        lambda instant: fitting.squares(at(instant)),
        bounds=(values[index] - reach, values[index] + reach),
        method="bounded",
        options={"xatol": 0.02 * step, "maxiter": INSTANT_TRIALS},
    )
    return at(float(found.x)) if found.fun < fitting.squares(model) else model


def rounds_of(terms: Iterable[Term], fitted: Fitted) -> list[list[FittedCandidate]]:
    """Terms as what was added to a selection, one after the other, of which `fitted` is the last model."""
    error = float(fitted.left_out.sum())
    return [[FittedCandidate(_guess(one), fitted, error)] for one in terms]


def _guess(term: Term) -> InitialGuess:
    """Where a fit of a term begins."""
    numbers = term.numbers
    scales = dict(zip(NUMBERS, (abs(term.size), *term.steps), strict=False))
    added = EffectInstance("plant", Formula.kind, term.dof, {"force": term.formula, **numbers})
    return InitialGuess(added, tuple(numbers), (NUMBERS[0],), scales)
