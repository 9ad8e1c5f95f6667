"""Add effects to a model, one at a time, as long as data that a fit has not seen are predicted better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rthm_analysis.diagnosis.criteria.fitting import POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.search import (
    FINISHED_CHI2,
    GIVEN_UP_LEFT_SHARE,
    IMITATOR_GIVEN_UP_CHI2,
    NEAR_NOISE_CHI2,
    SEARCH_MOST_EFFECTS,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.search.beside_wire import selected_from_wire
from rthm_analysis.diagnosis.search.combining import combined
from rthm_analysis.diagnosis.search.judging import (
    FittedCandidate,
    Selection,
    better,
    is_ahead,
    reduced_chi2,
    relevant,
)
from rthm_analysis.diagnosis.search.pairing import let_go, paired
from rthm_analysis.diagnosis.search.promising import (
    promising,
    screened,
    smallest_seen,
    still_promising,
    tones,
)
from rthm_analysis.diagnosis.search.refining import finished, refined
from rthm_analysis.diagnosis.search.replacing import compared, or_twin
from rthm_analysis.diagnosis.search.screening import ScoredCandidate, screen
from rthm_analysis.diagnosis.search.simplifying import simplified
from rthm_core.compiled import Floats


def never(reduced_chi2: float) -> bool:
    """Look for more as long as there is something to be found."""
    return False


def choose(
    fitting: Fitting, base: Fitted, stop: Callable[[float], bool] = never, begun: Selection | None = None
) -> Selection:
    """Explain what is left of the residual by effects.

    Parameters
    ----------
    fitting : Fitting
    base : Fitted
        Retuned model.
    stop : callable
        Whether to leave it at what was found, given the reduced chi-squared that is left.
    begun : Selection, optional
        What was found before, to go on with.
    """
    if begun and begun.rounds:
        return _going_on(fitting, _together(fitting, begun), stop)
    return _going_on(fitting, selected_from_wire(fitting, base, choose) or Selection(base, base), stop)


def _going_on(fitting: Fitting, selection: Selection, stop: Callable[[float], bool]) -> Selection:
    """Explain what a selection leaves by more effects, then ask whether others do better, or fewer."""
    scores = selection.scores
    while len(selection.rounds) < SEARCH_MOST_EFFECTS and not fitting.budget.spent:
        known = fitting.known(selection.best)
        scores = _scores(fitting, selection, known, scores)
        tried = _tried(fitting, selection, known, promising(scores))
        if not tried or not better(tried[0], selection.best) or not relevant(fitting, tried[0], selection):
            if not selection.rounds and stop(fitting.reduced_chi2):
                return selection
            break
        tried[0] = _settled(fitting, selection, tried[0], known)
        selection.rounds.append(tried)
        selection.best = tried[0].fitted
        selection = or_twin(fitting, selection)
        if stop(fitting.reduced_chi2):
            return selection
        selection = _together(fitting, selection)
    if is_lost(fitting, selection):
        return selection
    return replace(compared(fitting, simplified(fitting, combined(fitting, selection))), scores=scores)


def is_lost(fitting: Fitting, selection: Selection) -> bool:
    """Whether what was found is so far from the noise that nothing of it will be named.

    It leaves a good part of the mismatch, or is no plain kind, or no more work may be done: nothing is then
    gained by making it simpler.
    """
    left, before = reduced_chi2(fitting, selection.best), reduced_chi2(fitting, selection.base)
    if left < POOR_FIT_CHI2:
        return fitting.budget.spent and left > NEAR_NOISE_CHI2
    if selection.imitates and left > IMITATOR_GIVEN_UP_CHI2:
        return True
    return left - 1.0 > GIVEN_UP_LEFT_SHARE * (before - 1.0)


def _together(fitting: Fitting, selection: Selection) -> Selection:
    """The same, or several effects at once where those that were found do not come near the noise."""
    if fitting.reduced_chi2 > NEAR_NOISE_CHI2:
        selection = combined(fitting, selection)
    if len(selection.rounds) != 1 or fitting.reduced_chi2 < POOR_FIT_CHI2:
        return selection
    rounds = paired(fitting, selection.base, selection.rounds[0])
    return replace(selection, best=rounds[-1][0].fitted, rounds=rounds) if rounds else selection


def _scores(
    fitting: Fitting, selection: Selection, known: Floats, before: list[ScoredCandidate]
) -> list[ScoredCandidate]:
    """Score of every candidate; near the noise, from the best starts of the round before, and of tones that
    show now.
    """
    fitting.progress("looking for more" if selection.rounds else "looking for physics that was left out")
    if before and fitting.reduced_chi2 <= NEAR_NOISE_CHI2:
        present = {tried[0].label for tried in selection.rounds}
        others = [s.start for s in still_promising(before) if s.start.label not in present]
        return screen(fitting, selection.best, known, [*others, *tones(fitting, selection.best)])
    scores = screened(fitting, selection.best, known)
    if not selection.limits:
        selection.limits = smallest_seen(scores)
    return scores


def _tried(
    fitting: Fitting, selection: Selection, known: Floats, worth: list[ScoredCandidate]
) -> list[FittedCandidate]:
    """Refined candidates, best first."""
    if not worth:
        return []
    fitting.progress(f"refining {', '.join(dict.fromkeys(s.start.added.kind for s in worth))}")
    return _plain_first(fitting, selection, refined(fitting, selection.best, known, worth))


def _plain_first(
    fitting: Fitting, selection: Selection, tried: list[FittedCandidate]
) -> list[FittedCandidate]:
    """The same, the best plain kind first where no kind comes near the noise, or leaves next to nothing of
    what plain kinds leave.

    A kind with the freedom to imitate others says something only where it explains everything.
    """
    if not tried or not tried[0].law.flexible:
        return tried
    left = reduced_chi2(fitting, tried[0].fitted)
    plain = [one for one in tried if not one.law.flexible and better(one, selection.best)]
    plain = [one for one in plain if relevant(fitting, one, selection)]
    if left < NEAR_NOISE_CHI2 or not plain or is_ahead(left, reduced_chi2(fitting, plain[0].fitted)):
        return tried
    return [plain[0], *(one for one in tried if one is not plain[0])]


def _settled(fitting: Fitting, selection: Selection, best: FittedCandidate, known: Floats) -> FittedCandidate:
    """The effect that was chosen, fitted to its end where there may be more behind it."""
    lost, fitting.reduced_chi2 = fitting.reduced_chi2 > POOR_FIT_CHI2, reduced_chi2(fitting, best.fitted)
    if lost:
        fitting.rebase(best.fitted.model)
    if fitting.identified and fitting.reduced_chi2 < POOR_FIT_CHI2:
        best = finished(fitting, let_go(best, selection.base))
    elif lost or fitting.reduced_chi2 > FINISHED_CHI2:
        best = finished(fitting, best, None if lost else known)
    if fitting.experiment.sharpen(best.fitted.model.spec):
        best = finished(fitting, best)
    return best
