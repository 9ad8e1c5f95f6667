"""Where a diagnosis of the physical side begins: free runs, noise, loads between samples, retuned model."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import SECOND_QUESTION_STEPS
from rthm_analysis.diagnosis.criteria.search import FINISHED_CHI2, GAIN_OF_CHANCE, NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.criteria.verdict import (
    LONGEST_RUN_SHARE,
    NOISE_REVISED_RATIO,
    OTHER_BEGINNING_EXPLAINED_SHARE,
    REFIT_CHI2,
    STEPS_OF_ANOTHER_BEGINNING,
    WINDOWED_CHI2,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.noise import Noise, noise_levels, white_noise
from rthm_analysis.diagnosis.physical.colours import left_by
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.replay.between import Between, ways
from rthm_analysis.diagnosis.replay.budget import Budget
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model, uncertain
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_analysis.diagnosis.search.choosing import choose
from rthm_analysis.diagnosis.search.judging import Selection, reduced_chi2
from rthm_analysis.diagnosis.search.replacing import present
from rthm_core.compiled import Floats
from rthm_core.spec import Spec


class Baseline(NamedTuple):
    """Free runs over the whole recording, the noise of the channels, and what the spec alone can explain.

    What is `retuned` may only be near its best, where another way of the loads is likelier.
    """

    runs: Windows
    noise: Noise
    fitting: Fitting
    nominal: Fitted
    retuned: Fitted


def begin(
    seen: Evidence, settled: Model, first: Floats, budget: Budget, progress: Callable[[str], None]
) -> list[Baseline]:
    """Begin with the loads between their samples in every way that is possible.

    The first is the smooth curve, unless another leaves next to nothing.

    Parameters
    ----------
    seen : Evidence
    settled : Model
        With what was found in the motors.
    first : (m,) array
        Command in steady state before the test, m.
    budget : Budget
        Of the work that is done in any way.
    progress : callable
        Told what is being done, in words.
    """
    train = seen.trained
    parts = [Experiment(seen.first(train), first, between=way, budget=budget) for way in ways(seen)]
    runs, noise = _runs(seen, settled, train, parts[0])
    for part in parts[1:]:
        part.begin_at(seen.stamps_ns[runs.first(train).start])
        noise = noise.smaller(noise_left(part, settled.spec, runs.first(train)))
    begun: list[Baseline] = []
    for part in parts:
        fitting = fitting_of(part, runs.first(train), noise, settled, progress, simple=seen.comes_to_rest)
        nominal = fitting.fit(settled)
        while not begun and np.any(noise_of(fitting, nominal).level < NOISE_REVISED_RATIO * noise.level):
            noise = noise_of(fitting, nominal)
            fitting = fitting_of(part, runs.first(train), noise, settled, progress, simple=seen.comes_to_rest)
            nominal = fitting.fit(settled)
        near = (
            fitting.fit(begun[0].retuned.model, most=STEPS_OF_ANOTHER_BEGINNING)
            if begun
            else retuned_from(fitting, nominal)
        )
        begun.append(Baseline(runs, noise, fitting, nominal, near))
    best = min(begun, key=lambda one: one.retuned.squares)
    if _explains_most(best.fitting, best.retuned, begun[0].retuned):
        others = [one for one in begun if one is not best]
        begun = [best._replace(retuned=retuned_from(best.fitting, best.nominal)), *others]
    return begun


def fitting_of(
    part: Experiment,
    runs: Windows,
    noise: Noise,
    base: Model,
    progress: Callable[[str], None],
    *,
    simple: bool,
) -> Fitting:
    """Fits of the training part that weigh its channels by their noise.

    They are `simple` where the unseen part has come to rest: it cannot confirm what may imitate others.
    """
    return Fitting(part, runs, noise.sigma, base, progress, colours=noise.colours, simple=simple)


def with_noise(begun: Baseline, noise: Noise) -> Baseline:
    """The same, judged by another noise."""
    before = begun.fitting
    fitting = fitting_of(
        before.experiment, before.windows, noise, before.base, before.progress, simple=before.simple
    )
    nominal = fitting.fit(begun.nominal.model)
    return Baseline(begun.runs, noise, fitting, nominal, retuned_from(fitting, nominal))


def in_short_runs(begun: Baseline, seen: Evidence, settled: Model, train: int) -> Baseline:
    """The same in short runs, in which a model that is wrong does not get far from the recording."""
    longer = begun.fitting
    longer.progress("looking in short runs, where a wrong model stays near")
    runs = windows(seen, settled.spec, seen.driven_by == "command", short=True)
    fitting = fitting_of(
        longer.experiment, runs.first(train), begun.noise, settled, longer.progress, simple=longer.simple
    )
    nominal = fitting.fit(settled)
    return Baseline(runs, begun.noise, fitting, nominal, retuned_from(fitting, nominal))


def _explains_most(fitting: Fitting, new: Fitted, old: Fitted) -> bool:
    """Whether little is left of what was: far from the noise, the smaller of two errors says nothing."""
    left = old.squares - fitting.expected
    return old.squares - new.squares > max(OTHER_BEGINNING_EXPLAINED_SHARE * left, GAIN_OF_CHANCE)


def choose_again(begun: Baseline, others: list[Baseline], selection: Selection) -> tuple[Baseline, Selection]:
    """Take another way of the loads where it explains more with the effects that were chosen.

    What is missing may have made a wrong way look right. The right one then explains most of what is left.
    """
    fitting = begun.fitting
    if fitting.reduced_chi2 < FINISHED_CHI2 or selection.formulas:
        return _by_kinds(begun, others, selection) or (begun, selection)
    for other in others:
        there = _best_there(other, selection)
        if there is None:
            continue
        alike = other.runs.length == begun.runs.length
        near = reduced_chi2(other.fitting, there) < NEAR_NOISE_CHI2
        if near or (alike and _explains_most(fitting, there, selection.best)):
            again = choose(other.fitting, retuned_from(other.fitting, other.nominal))
            if not alike or again.best.squares < selection.best.squares:
                return other, again
    return _by_kinds(begun, others, selection) or (begun, selection)


def _by_kinds(
    begun: Baseline, others: list[Baseline], selection: Selection
) -> tuple[Baseline, Selection] | None:
    """Kinds that leave nothing but noise under smooth loads, where another way was chosen before the search
    and no kinds do so there: half a sample by which a held load is late is like a damper that is missing.
    """
    fitting = begun.fitting
    if fitting.experiment.between is Between.SMOOTH:
        return None
    if not selection.formulas and at_noise(fitting, selection.best):
        return None
    for other in others:
        if other.fitting.experiment.between is Between.SMOOTH:
            other.fitting.budget.allow(SECOND_QUESTION_STEPS)
            found = choose(other.fitting, retuned_from(other.fitting, other.nominal))
            return (other, found) if at_noise(other.fitting, found.best) else None
    return None


def _best_there(other: Baseline, selection: Selection) -> Fitted | None:
    """Fit of what was chosen, all of it or one effect beside the nominal model; None where all diverge.

    Everything else may have made up for the wrong way.
    """
    best, found = selection.best.model, []
    alone = [start.added_to(other.nominal.model) for start in present(selection)]
    for model in [best, *alone]:
        with suppress(np.linalg.LinAlgError):
            found.append(other.fitting.fit(model, most=STEPS_OF_ANOTHER_BEGINNING))
    return min(found, key=lambda fitted: fitted.squares, default=None)


def retuned_from(fitting: Fitting, nominal: Fitted) -> Fitted:
    """Fit of what the spec calls uncertain, the data counting the less the further they stay away."""
    fitting.progress("retuning what is uncertain")
    fitting.reduced_chi2 = reduced_chi2(fitting, nominal)
    retuned = best_of_starts(fitting, with_unsure(fitting.experiment.evidence, nominal.model))
    near = fitted_near(fitting, retuned)
    if near is not retuned and reduced_chi2(fitting, near) < NEAR_NOISE_CHI2:
        fitting.rebase(near.model)
    return near


def with_unsure(seen: Evidence, model: Model) -> Model:
    """A nominal model with what its spec calls uncertain as parameters.

    Where nothing known drives the plant, its first mass is taken as it is.
    """
    known = () if seen.is_forced else ("plant.mass", "plant.mass[0]")
    unsure = [p for p in uncertain(model.nominal) if p.key not in known]
    return replace(model, parameters=(*model.parameters, *unsure))


def fitted_near(fitting: Fitting, found: Fitted) -> Fitted:
    """The same, fitted again where it is much nearer to the recording than what was fitted from.

    The initial states then change the prediction as they do in the model that was found: over many periods
    those of one that is off are out of step.
    """
    if fitting.reduced_chi2 <= REFIT_CHI2:
        return found
    fitting.reduced_chi2 = reduced_chi2(fitting, found)
    with fitting.based_on(found.model):
        return fitting.fit(found.model)


def best_of_starts(fitting: Fitting, model: Model) -> Fitted:
    """Best of two fits: a start that is a little off can imitate wrong parameters, and a fit gets stuck."""
    fits = [fitting.fit(model)]
    if model.parameters and fitting.windows.length is None:
        fits.append(fitting.fit(fitting.fit(model, started=True).model))
    return min(fits, key=lambda fitted: fitted.squares)


def _runs(seen: Evidence, settled: Model, train: int, part: Experiment) -> tuple[Windows, Noise]:
    """Free runs as long as the nominal model stays near the recording, and the noise that they show."""
    longer = 1.0
    while True:
        runs = windows(seen, settled.spec, seen.driven_by == "command", longer)
        part.begin_at(seen.stamps_ns[runs.first(train).start])
        noise = noise_left(part, settled.spec, runs.first(train))
        if runs.length is None or runs.length > LONGEST_RUN_SHARE * seen.longest:
            return runs, noise
        fitting = Fitting(part, runs.first(train), noise.sigma, settled)
        if reduced_chi2(fitting, fitting.fit(settled)) > WINDOWED_CHI2:
            return runs, noise
        longer *= 2.0


def noise_of(fitting: Fitting, fitted: Fitted) -> Noise:
    """White noise of the channels that a fitted model leaves, the initial states fitted, too."""
    evidence = fitting.experiment.evidence
    left = left_by(fitting, fitted)
    return white_noise(noise_levels(left, evidence.measured))


def noise_left(experiment: Experiment, spec: Spec, runs: Windows) -> Noise:
    """White noise of the channels; more than that where a spec leaves out what is as fast as noise."""
    measured = experiment.evidence.measured
    return white_noise(noise_levels(measured - experiment.predicted(spec, runs), measured))
