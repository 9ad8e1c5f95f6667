"""Terms of a formula as effects of a model."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    FORMULA_FIT_BUDGET,
    FORMULA_FIT_STEPS,
    FORMULA_LEFT_RATIO,
    INSTANT_MOVES,
    INSTANT_SAMPLES,
    INSTANT_TRIALS,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.formula import NUMBERS
from rthm_core.effects.written import Formula, Written

INSTANT = re.compile(r"\((\w) < t\)|\(t < (\w)\)")
"""An instant at which a term begins, or ends."""


def guess_of(term: Term, law: type[Written] = Formula) -> InitialGuess:
    """Where a fit of a term begins, in the block of a law that is written."""
    numbers = term.numbers
    scales = dict(zip(NUMBERS, (abs(term.size), *term.steps), strict=False))
    added = EffectInstance(law.blocks[0], law.kind, term.site, {law.text: term.formula, **numbers})
    return InitialGuess(added, tuple(numbers), (NUMBERS[0],), scales)


def with_all(model: Model, guesses: Iterable[InitialGuess]) -> Model:
    """A model with some formulas beside its effects."""
    for one in guesses:
        model = one.added_to(model)
    return model


def fit_terms(fitting: Fitting, model: Model, times: int = 1) -> Fitted | None:
    """Fit of a model with terms, gone on with so many times where that gains much; None where it diverges.

    Between two steps of a replay an instant at which a term begins or ends changes nothing, so no slope leads
    to it: it is looked for by itself, among the samples around it.
    """
    try:
        fitting.budget.allow(FORMULA_FIT_BUDGET)
        fitting.rebase(model)  # a force that was missing changes how initial states show
        fitted = _fitted(fitting, model, times)
        for key in _instants(fitted.model):
            for _ in range(INSTANT_MOVES):
                moved = _moved(fitting, fitted.model, key)
                if moved is fitted.model:
                    break
                fitted = fitting.fit(moved, most=FORMULA_FIT_STEPS, affordable=True)
    except np.linalg.LinAlgError:
        return None
    return fitted


def _fitted(fitting: Fitting, model: Model, times: int) -> Fitted:
    """Fit that goes on as long as it gains much: on a ridge every step is short."""
    left = np.inf
    for _ in range(times):
        fitted = fitting.fit(model, most=FORMULA_FIT_STEPS, affordable=True)
        if fitted.squares > FORMULA_LEFT_RATIO * left or fitting.budget.spent:
            break
        model, left = fitted.model, fitted.squares
    return fitted


def _instants(model: Model) -> list[str]:
    """Keys of the instants at which terms of a model begin or end."""
    found = []
    for index, one in enumerate(model.added):
        text = str(one.parameters.get("force", ""))
        found += [f"{model.name(index)}.{first or last}" for first, last in INSTANT.findall(text)]
    return found


def _moved(fitting: Fitting, model: Model, key: str) -> Model:
    """The model with an instant where it leaves least, of some around it."""
    index = [p.key for p in model.parameters].index(key)
    values, step = model.values, float(np.median(np.diff(fitting.experiment.evidence.time)))

    def at(instant: float) -> Model:
        return model.at(np.concatenate([values[:index], [instant], values[index + 1 :]]))

    apart = step * np.linspace(-INSTANT_SAMPLES, INSTANT_SAMPLES, INSTANT_TRIALS)
    tried = [model, *map(at, values[index] + apart)]
    return tried[int(np.argmin(fitting.squares_near(model, tried)))]


def rounds_of(guesses: Iterable[InitialGuess], fitted: Fitted) -> list[list[FittedCandidate]]:
    """Formulas as what was added to a selection, one after the other, of which `fitted` is the last model."""
    error = float(fitted.left_out.sum())
    return [[FittedCandidate(one, fitted, error)] for one in guesses]
