"""A formula term by term in short runs, where a wrong model stays near the recording.

Over many periods a model that lacks one of two forces is out of step whatever the other is, so that the whole
recording shows neither. In short runs each is fitted before the next is looked for; then the runs grow, as a
model that is nearly right stays near for longer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    FORMULA_FIT_STEPS,
    FORMULA_STEPS,
    LONGER_RUNS_RATIOS,
    PLAIN_TERM_LEFT_RATIO,
    TERM_LEFT_RATIO,
    TERMS_OF_A_FORMULA,
)
from rthm_analysis.diagnosis.criteria.verdict import LOST_CHI2
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.noise import Noise
from rthm_analysis.diagnosis.missing.curves import Regression, free_curves
from rthm_analysis.diagnosis.missing.formulas import composed, fitted_together, plainest
from rthm_analysis.diagnosis.missing.likely import likely
from rthm_analysis.diagnosis.missing.plain import plain_sets
from rthm_analysis.diagnosis.physical.beginning import fitting_of, with_unsure
from rthm_analysis.diagnosis.physical.formula_model import fit_terms, guess_of, with_all
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.physical.named_laws import guesses_of, without_repeated
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.budget import Budget, budget_for
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.starting import refined
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_analysis.diagnosis.search.judging import reduced_chi2
from rthm_analysis.diagnosis.search.starts import InitialGuess


class Composed(NamedTuple):
    """A model with terms of a formula behind its other effects, and where these terms began."""

    model: Model
    guesses: list[InitialGuess]

    @property
    def allowed_ratio(self) -> float:
        """What its last law may leave, over what was left before."""
        return PLAIN_TERM_LEFT_RATIO if len(self.guesses[-1].free) == 1 else TERM_LEFT_RATIO


def term_by_term(physical: Physical, base: Fitted) -> Iterator[Composed]:
    """Models with one term more each, as short runs of the training part show them, fitted in ever longer
    runs; none where the base does not get lost over the whole.
    """
    if reduced_chi2(physical.fitting, base) < LOST_CHI2:
        return
    fitting = _in_runs(physical, 1.0)
    model = _as_specified(physical, base.model)
    fitted = fitting.fit(model)
    guesses: list[InitialGuess] = []
    fitting.reduced_chi2 = reduced_chi2(fitting, fitted)
    budget = budget_for(physical.train, FORMULA_STEPS)
    for plain in _plain(_left_by(model, fitting, physical.noise, budget), fitting, model):
        yield Composed(_in_longer_runs(physical, plain.model), plain.guesses)
    while len(guesses) < TERMS_OF_A_FORMULA and not at_noise(fitting, fitted):
        before = fitting.reduced_chi2 = reduced_chi2(fitting, fitted)
        more = _next(_left_by(model, fitting, physical.noise, budget), fitting, model)
        better = fit_terms(fitting, more.model) if more is not None else None
        if more is None or better is None or reduced_chi2(fitting, better) > more.allowed_ratio * before:
            return
        fitted, model, guesses = better, better.model, [*guesses, *more.guesses]
        yield Composed(_in_longer_runs(physical, model), guesses)


def _as_specified(physical: Physical, base: Model) -> Model:
    """A model with the values that the spec states, and with what it calls uncertain: a fit has bent them, or
    chosen among them, to make up for what is missing.
    """
    model = base if base.added else with_unsure(physical.evidence, physical.nominal.model)
    return model.at(np.array([p.prior[0] if p.prior else p.value for p in model.parameters]))


def beginning_as(physical: Physical, model: Model) -> Physical:
    """The same with free runs that begin where they fit a model best."""
    seen = physical.evidence
    if seen.driven_by != "force":
        return physical
    runs = refined(seen, model.spec, physical.windows, seen.period, bent=True)
    return replace(physical, windows=runs, fitting=_fitting_in(physical, runs))


def _fitting_in(physical: Physical, runs: Windows) -> Fitting:
    whole, train = physical.fitting, runs.first(physical.train)
    return fitting_of(
        whole.experiment, train, physical.noise, physical.nominal.model, whole.progress, simple=whole.simple
    )


def _in_runs(physical: Physical, longer: float) -> Fitting:
    """Fits of the training part in runs so much longer than a period of the motion."""
    seen = physical.evidence
    runs = windows(seen, physical.settled, seen.driven_by == "command", longer, short=True)
    return _fitting_in(physical, runs)


def _left_by(model: Model, fitting: Fitting, noise: Noise, budget: Budget) -> Regression:
    """What a model leaves of all samples of the runs."""
    samples = fitting.experiment.evidence.time.size
    return Regression(fitting.experiment, fitting.windows, noise, model, samples, budget)


def _next(left: Regression, fitting: Fitting, model: Model) -> Composed | None:
    """A model with one more law, of a term or two, of which these begin; None where there is none."""
    curves = free_curves(left, likely(fitting.experiment, fitting.windows, model.spec))
    terms = composed(left, curves, most=1)
    if not terms:
        return None
    model, terms = fitted_together(left, plainest(left, curves, *terms))
    guesses = [guess_of(one) for one in terms]
    return Composed(with_all(model, guesses), guesses)


def _plain(left: Regression, fitting: Fitting, model: Model) -> Iterator[Composed]:
    """Models with plain laws that short runs show together, one more each, fitted there."""
    for found in plain_sets(left):
        if not (some := without_repeated(left, model, found)):
            continue
        beside, terms = fitted_together(left, some)
        guesses = guesses_of(left, model, terms)
        if not guesses[-1].added.law.written:
            continue
        fitted = fit_terms(fitting, with_all(beside, guesses))
        if fitted is not None:
            yield Composed(fitted.model, guesses)


def _in_longer_runs(physical: Physical, model: Model) -> Model:
    """A model fitted in ever longer runs, as far as it follows the recording there."""
    for longer in LONGER_RUNS_RATIOS if physical.windows.length is None else ():
        fitting = _in_runs(physical, longer)
        if fitting.windows.length is None or fitting.windows.length > 0.5 * physical.evidence.longest:
            break
        fitting.reduced_chi2 = LOST_CHI2
        try:
            model = fitting.fit(model, most=FORMULA_FIT_STEPS).model
        except np.linalg.LinAlgError:
            break
    return model
