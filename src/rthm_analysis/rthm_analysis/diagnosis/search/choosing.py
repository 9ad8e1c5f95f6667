"""Add effects to a model, one at a time, as long as data that a fit has not seen are predicted better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rthm_analysis.diagnosis.fitting.fitting import WRONG, Fitted, Fitting
from rthm_analysis.diagnosis.search.beside_wires import led_by_a_wire
from rthm_analysis.diagnosis.search.combining import combined
from rthm_analysis.diagnosis.search.judging import (
    CLOSE,
    FLEXIBLE,
    UNFINISHED,
    Choice,
    Tried,
    better,
    doubt,
    relevant,
)
from rthm_analysis.diagnosis.search.pairing import let_go, paired
from rthm_analysis.diagnosis.search.promising import promising, screened, smallest_seen
from rthm_analysis.diagnosis.search.refining import finished, refined
from rthm_analysis.diagnosis.search.replacing import compared
from rthm_analysis.diagnosis.search.screening import Screened, best_of_each, screen
from rthm_analysis.diagnosis.search.simplifying import simplified
from rthm_core.compiled import Floats

MOST_EFFECTS = 3

LOST = 0.3
"""Part of a mismatch above the noise, left by what was found, from which the search is given up."""

FAR = 30.0
"""Doubt from which kinds that can imitate others, and do not, are given up."""


def never(doubt: float) -> bool:
    """Look for more as long as there is something to be found."""
    return False


def choose(
    fitting: Fitting, base: Fitted, stop: Callable[[float], bool] = never, begun: Choice | None = None
) -> Choice:
    """Explain what is left of the residual by effects.

    Parameters
    ----------
    fitting : Fitting
    base : Fitted
        Retuned model.
    stop : callable
        Whether to leave it at what was found, given the doubt that is left.
    begun : Choice, optional
        What was found before, to go on with.
    """
    if begun and begun.rounds:
        return _going_on(fitting, _together(fitting, begun), stop)
    return _going_on(fitting, led_by_a_wire(fitting, base) or Choice(base, base), stop)


def _going_on(fitting: Fitting, choice: Choice, stop: Callable[[float], bool]) -> Choice:
    """Explain what a choice leaves by more effects, then ask whether others do better, or fewer."""
    scores: list[Screened] = []
    while len(choice.rounds) < MOST_EFFECTS and not fitting.budget.spent:
        known = fitting.known(choice.best)
        scores = _scores(fitting, choice, known, scores)
        tried = _tried(fitting, choice, known, promising(scores))
        if not tried or not better(tried[0], choice.best) or not relevant(fitting, tried[0], choice):
            break
        tried[0] = _settled(fitting, choice, tried[0], known)
        choice.rounds.append(tried)
        choice.best = tried[0].fitted
        if stop(fitting.doubt):
            return choice
        choice = _together(fitting, choice)
    if is_lost(fitting, choice):
        return choice
    return compared(fitting, simplified(fitting, combined(fitting, choice)))


def is_lost(fitting: Fitting, choice: Choice) -> bool:
    """Whether what was found is so far from the noise that nothing of it will be named.

    It leaves a good part of the mismatch, or is no plain kind, or no more work may be done: nothing is then
    gained by making it simpler.
    """
    left, before = doubt(fitting, choice.best), doubt(fitting, choice.base)
    if left < WRONG:
        return fitting.budget.spent and left > CLOSE
    if choice.imitates and left > FAR:
        return True
    return left - 1.0 > LOST * (before - 1.0)


def _together(fitting: Fitting, choice: Choice) -> Choice:
    """The same, or several effects at once where those that were found do not come near the noise."""
    if fitting.doubt > CLOSE:
        choice = combined(fitting, choice)
    if len(choice.rounds) != 1 or fitting.doubt < WRONG:
        return choice
    rounds = paired(fitting, choice.base, choice.rounds[0])
    return replace(choice, best=rounds[-1][0].fitted, rounds=rounds) if rounds else choice


def _scores(fitting: Fitting, choice: Choice, known: Floats, before: list[Screened]) -> list[Screened]:
    """Score of every candidate; near the noise, from the best starts of the round before."""
    fitting.progress("looking for more" if choice.rounds else "looking for physics that was left out")
    if before and fitting.doubt <= CLOSE:
        present = {tried[0].label for tried in choice.rounds}
        others = [s.start for s in best_of_each(before, 1) if s.start.label not in present]
        return screen(fitting, choice.best, known, others)
    scores = screened(fitting, choice.best, known)
    if not choice.limits:
        choice.limits = smallest_seen(scores)
    return scores


def _tried(fitting: Fitting, choice: Choice, known: Floats, worth: list[Screened]) -> list[Tried]:
    """Refined candidates, best first."""
    if not worth:
        return []
    fitting.progress(f"refining {', '.join(dict.fromkeys(s.start.added.kind for s in worth))}")
    return _plain_first(fitting, choice, refined(fitting, choice.best, known, worth))


def _plain_first(fitting: Fitting, choice: Choice, tried: list[Tried]) -> list[Tried]:
    """The same, the best plain kind first where no kind comes near the noise.

    A kind with the freedom to imitate others says something only where it explains everything.
    """
    if not tried or tried[0].label[1] not in FLEXIBLE or doubt(fitting, tried[0].fitted) < CLOSE:
        return tried
    plain = [one for one in tried if one.label[1] not in FLEXIBLE and better(one, choice.best)]
    plain = [one for one in plain if relevant(fitting, one, choice)]
    return [*plain[:1], *(one for one in tried if not plain or one is not plain[0])]


def _settled(fitting: Fitting, choice: Choice, best: Tried, known: Floats) -> Tried:
    """The effect that was chosen, fitted to its end where there may be more behind it."""
    lost, fitting.doubt = fitting.doubt > WRONG, doubt(fitting, best.fitted)
    if lost:
        fitting.rebase(best.fitted.model)
    if fitting.told and fitting.doubt < WRONG:
        best = finished(fitting, let_go(best, choice.base))
    elif lost or fitting.doubt > UNFINISHED:
        best = finished(fitting, best, None if lost else known)
    if fitting.experiment.sharpen(best.fitted.model.spec):
        best = finished(fitting, best)
    return best
