"""Fit the candidates that a screening promised: the better they do, the longer."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any, cast

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import FIT_GAIN, POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.search import (
    FINISHED_CHI2,
    FINISHING_GAIN,
    FINISHING_STEPS,
    HEAT_ERROR_RATIO,
    HEAT_ERROR_SHARE_OF_NOISE,
    HEATS,
    IMITATORS_FITTED,
    NEAR_NOISE_CHI2,
    RELEVANT_SHARE_OF_FIRST,
    STARTING_SIZE_SHARES,
    SUFFICIENT_LEFT_SHARE,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import (
    FittedCandidate,
    best_of_labels,
    distinguishable,
    noise_and_no_more,
    reduced_chi2,
)
from rthm_analysis.diagnosis.search.screening import ScoredCandidate
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.tone_evidence import without_unproven_tones
from rthm_core.compiled import Floats
from rthm_core.effects import Plainer
from rthm_core.errors import InputError


def refined(
    fitting: Fitting, fitted: Fitted, known: Floats, promising: list[ScoredCandidate]
) -> list[FittedCandidate]:
    """Fit the promising candidates, the better the longer; best first by what data left out say.

    Kinds that need many short steps are fitted where no plain kind suffices.
    """
    quick, slow = ([one for one in promising if one.start.added.law.kinked == way] for way in (False, True))
    begun = partial(_begun_fits, fitting, fitted, known)
    tried = _in_heats(fitting, known, begun(quick, []))
    enough = _sufficient_chi2(fitting, fitted)
    if slow and not any(_suffices(fitting, one, enough) for one in tried):
        tried = _in_heats(fitting, known, [*tried, *begun(slow, tried)])
    meaningful = [one for one in tried if _meaningful(one)]
    ordered = _simplest_first(fitting, best_of_labels(meaningful), fitted)
    return without_unproven_tones(fitting, ordered, fitted)


def _begun_fits(
    fitting: Fitting,
    fitted: Fitted,
    known: Floats,
    promising: list[ScoredCandidate],
    others: list[FittedCandidate],
) -> list[FittedCandidate]:
    """First steps of the fits of some candidates, and of kinds that grow from a plainer one of all.

    What the gain of a sensor explains, other masses and springs may have made up for.
    """

    def first(start: InitialGuess, model: Model, steps: int = HEATS[0][0]) -> FittedCandidate:
        return fit_further(fitting, unfitted(start, fitted, model), known, steps)

    def begun(one: ScoredCandidate) -> FittedCandidate:
        return first(one.start, _begun(fitting, fitted.model, one))

    tried = fitting.each_affordable(begun, promising)
    grown = [*_grown([*others, *tried], promising)]
    tried += fitting.each_affordable(lambda start: first(start, start.added_to(fitted.model)), grown)
    moved = fitted.model.unlikeliness > 0.0
    gains = [one.start for one in promising if moved and one.start.added.law.changes == "gain"]
    stated = fitted.model.as_stated
    tried += fitting.each_affordable(lambda start: first(start, start.added_to(stated), HEATS[-1][0]), gains)
    return [one for one in tried if np.isfinite(one.error)]


def _in_heats(fitting: Fitting, known: Floats, tried: list[FittedCandidate]) -> list[FittedCandidate]:
    """The same, the better ones fitted longer."""
    for steps, most in HEATS[1:]:
        tried = sorted(tried, key=lambda t: t.fitted.squares)
        most = 1 if fitting.budget.spent else min(most, _within_reach(fitting, tried))
        further = partial(fit_further, fitting, known=known, steps=steps)
        longer = fitting.each_affordable(further, tried[:most])
        tried = [*longer, *tried[len(longer) :]]
    return _beside_an_imitator(fitting, known, tried)


def _beside_an_imitator(
    fitting: Fitting, known: Floats, tried: list[FittedCandidate]
) -> list[FittedCandidate]:
    """The same, others that imitate as well fitted longer where the best one does and leaves more than noise:
    it may be one of these, whose fit has not come near yet.
    """
    ordered = sorted(tried, key=lambda t: t.fitted.squares)
    if not ordered or not ordered[0].law.flexible:
        return tried
    best, *others = ordered
    if reduced_chi2(fitting, best.fitted) < NEAR_NOISE_CHI2:
        return tried
    rivals = [one for one in best_of_labels(others) if one.law.flexible and one.label != best.label]
    further = partial(fit_further, fitting, known=known, steps=HEATS[-1][0])
    return [*tried, *fitting.each_affordable(further, rivals[:IMITATORS_FITTED])]


def _sufficient_chi2(fitting: Fitting, before: Fitted) -> float:
    """Reduced chi-squared below which a plain kind leaves no room for others.

    What a draft may leave for being coarse is the whole of a mismatch that is small itself.
    """
    of_mismatch = 1.0 + SUFFICIENT_LEFT_SHARE * (reduced_chi2(fitting, before) - 1.0)
    return min(noise_and_no_more(fitting), max(FINISHED_CHI2, of_mismatch))


def _suffices(fitting: Fitting, tried: FittedCandidate, enough: float) -> bool:
    """Whether a plain kind leaves noise and no more."""
    return not tried.law.flexible and reduced_chi2(fitting, tried.fitted) < enough


def unfitted(start: InitialGuess, fitted: Fitted, model: Model) -> FittedCandidate:
    """A candidate that is added to a fitted model, with its values in `model`, before any fit."""
    return FittedCandidate(start, replace(fitted, model=model, settled=np.inf), np.inf)


def _grown(tried: list[FittedCandidate], promising: list[ScoredCandidate]) -> Iterator[InitialGuess]:
    """Starts of kinds from the plainer one that fits best, which is most of them."""
    firsts: dict[tuple[str, str], InitialGuess] = {}
    for one in promising:
        firsts.setdefault(one.start.added.label, one.start)
    for start in firsts.values():
        for plainer in start.added.law.plainer:
            if plainer.beyond is not None:
                yield from _beyond(plainer, start, tried)


def _beyond(plainer: Plainer, start: InitialGuess, tried: list[FittedCandidate]) -> Iterator[InitialGuess]:
    """Starts of a kind from the fit of one plainer kind; none where that could not be fitted."""
    label = start.added.block, plainer.kind
    fitted = [one for one in tried if one.label[:2] == label and np.isfinite(one.error)]
    if not fitted:
        return
    best = min(fitted, key=lambda one: one.error)
    plain = best.fitted.model.effect_values(len(best.fitted.model.added) - 1)
    beyond = cast("Callable[..., Iterable[dict[str, Any]]]", plainer.beyond)
    for values in beyond(plain, start.added.parameters):
        added = replace(start.added, place=best.label[2], parameters=values)
        yield replace(start, added=added, scales=dict(values))


def _begun(fitting: Fitting, model: Model, one: ScoredCandidate) -> Model:
    """Where the fit of a candidate begins: where it is large, what the model has already moves with it.

    The size was found as if everything were linear, so parts of it are tried as well.
    """
    whole = one.start.added_to(model)
    if fitting.reduced_chi2 < POOR_FIT_CHI2 or not one.shift.size:
        return whole
    begun = []
    for part in STARTING_SIZE_SHARES:
        start = one.start.sized(part)
        moved = model.at(model.values + part * one.shift)
        begun.append(moved.plus(start.added, start.free, one.start.scales))
    return min([whole, *begun], key=fitting.squares)


def _meaningful(tried: FittedCandidate) -> bool:
    """Whether the recording depends on the parameters.

    An effect that never acts may still move the last digits of a simulation.
    """
    own = np.diag(tried.fitted.sums.hessian.sum(0))[-len(tried.start.free) :] if tried.start.free else [1.0]
    return bool(np.any(own))


def _simplest_first(fitting: Fitting, tried: list[FittedCandidate], without: Fitted) -> list[FittedCandidate]:
    """Put a simpler candidate before the best where neither reaches the noise and hardly anything is lost.

    What is then left is no noise, against which a further parameter could be weighed.
    """
    noise = fitting.expected
    if not tried or tried[0].error < NEAR_NOISE_CHI2 * noise:
        return tried
    gain = float(without.left_out.sum()) - tried[0].error
    if gain <= 0.0:
        return tried
    close = [t for t in tried if t.error - tried[0].error < RELEVANT_SHARE_OF_FIRST * gain]
    equal = [t for t in close if not distinguishable(tried[0].fitted, t.fitted)]
    first = min(equal, key=lambda t: len(t.fitted.model.parameters))
    return [first, *(t for t in tried if t is not first)]


def _within_reach(fitting: Fitting, tried: list[FittedCandidate]) -> int:
    """Of candidates in the order of their errors, how many may still become the best."""
    noise = fitting.expected
    best = tried[0].fitted.squares if tried else 0.0
    return sum(
        t.fitted.squares - noise < max(HEAT_ERROR_RATIO * (best - noise), HEAT_ERROR_SHARE_OF_NOISE * noise)
        for t in tried
    )


def fit_further(
    fitting: Fitting,
    tried: FittedCandidate,
    known: Floats | None,
    steps: int,
    least: float = FIT_GAIN,
    *,
    affordable: bool = False,
) -> FittedCandidate:
    """Go on fitting for some steps, as long as each brings at least this part, and is `affordable`."""
    if tried.fitted.settled <= least:
        return tried
    try:
        fitted = fitting.fit(tried.fitted.model, known, steps, least, affordable=affordable)
        return FittedCandidate.of(tried.start, fitted)
    except (InputError, np.linalg.LinAlgError):
        return tried


def finished_by_itself(fitting: Fitting, tried: FittedCandidate) -> FittedCandidate:
    """Fit to the end what may be far from the model before: with its own sensitivities to the initial states.

    It goes no further than the budget allows. The reduced chi-squared stays that of the model before.
    """
    before = fitting.reduced_chi2
    done = finished(fitting, tried, affordable=True)
    if np.isfinite(done.error) and fitting.reduced_chi2 < POOR_FIT_CHI2:
        with fitting.based_on(done.fitted.model):
            whole = unfitted(done.start, done.fitted, done.fitted.model)
            done = finished(fitting, whole, affordable=True)
    fitting.reduced_chi2 = before
    return done


def finished(
    fitting: Fitting, tried: FittedCandidate, known: Floats | None = None, *, affordable: bool = False
) -> FittedCandidate:
    """Fit an effect that was chosen to its end, from columns that are still known."""
    done = fit_further(fitting, tried, known, FINISHING_STEPS, FINISHING_GAIN, affordable=affordable)
    fitting.reduced_chi2 = reduced_chi2(fitting, done.fitted)
    return done
