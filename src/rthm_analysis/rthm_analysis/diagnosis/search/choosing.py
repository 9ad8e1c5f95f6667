"""Add effects to a model, one at a time, as long as data that a fit has not seen are predicted better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import WRONG, Fitted, Fitting
from rthm_analysis.diagnosis.search.combining import combined
from rthm_analysis.diagnosis.search.judging import (
    CLOSE,
    FLEXIBLE,
    UNFINISHED,
    Choice,
    Tried,
    best_of_labels,
    better,
    doubt,
    relevant,
)
from rthm_analysis.diagnosis.search.pairing import let_go, paired
from rthm_analysis.diagnosis.search.promising import promising, screened, smallest_seen
from rthm_analysis.diagnosis.search.refining import finished, fit_further, refined, unfitted
from rthm_analysis.diagnosis.search.replacing import compared
from rthm_analysis.diagnosis.search.screening import Screened, best_of_each, screen
from rthm_analysis.diagnosis.search.simplifying import simplified
from rthm_analysis.diagnosis.search.told_wires import told_wire
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
    choice = _together(fitting, begun, begun.rounds[0]) if begun and begun.rounds else Choice(base, base)
    scores: list[Screened] = []
    told = [] if choice.rounds else _told(fitting, base)
    while len(choice.rounds) < MOST_EFFECTS and not fitting.budget.spent:
        known = fitting.known(choice.best)
        scores = _scores(fitting, choice, known, scores)
        tried = _tried(fitting, choice, known, promising(scores), told)
        if not tried or not better(tried[0], choice.best) or not relevant(fitting, tried[0], choice):
            break
        tried[0] = _settled(fitting, choice, tried[0], known, told=any(tried[0] is one for one in told))
        choice.rounds.append(tried)
        choice.best = tried[0].fitted
        if stop(fitting.doubt):
            return choice
        choice = _together(fitting, choice, told or tried)
        told = []
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


def _together(fitting: Fitting, choice: Choice, firsts: list[Tried]) -> Choice:
    """The same, or several effects at once where those that were found do not come near the noise."""
    if fitting.doubt > CLOSE:
        choice = combined(fitting, choice)
    if len(choice.rounds) != 1 or fitting.doubt < WRONG:
        return choice
    rounds = paired(fitting, choice.base, firsts, choice.rounds[0])
    return replace(choice, best=rounds[-1][0].fitted, rounds=rounds) if rounds else choice


def _scores(fitting: Fitting, choice: Choice, known: Floats, before: list[Screened]) -> list[Screened]:
    """Score of every candidate; near the noise, from the best starts of the round before."""
    first = not choice.rounds
    fitting.progress("looking for physics that was left out" if first else "looking for more")
    if before and fitting.doubt <= CLOSE:
        present = {tried[0].label for tried in choice.rounds}
        others = [s.start for s in best_of_each(before, 1) if s.start.label not in present]
        return screen(fitting, choice.best, known, others)
    scores = screened(fitting, choice.best, known)
    if first:
        choice.limits = smallest_seen(scores)
    return scores


def _tried(
    fitting: Fitting, choice: Choice, known: Floats, worth: list[Screened], told: list[Tried]
) -> list[Tried]:
    """Refined candidates, best first, what the force of a wire told among them."""
    if not worth:
        return []
    fitting.progress(f"refining {', '.join(dict.fromkeys(s.start.added.kind for s in worth))}")
    tried = _plain_first(fitting, choice, refined(fitting, choice.best, known, worth))
    return best_of_labels([*told, *tried]) if told else tried


def _plain_first(fitting: Fitting, choice: Choice, tried: list[Tried]) -> list[Tried]:
    """The same, the best plain kind first where no kind comes near the noise.

    A kind with the freedom to imitate others says something only where it explains everything.
    """
    if not tried or tried[0].label[1] not in FLEXIBLE or doubt(fitting, tried[0].fitted) < CLOSE:
        return tried
    plain = [one for one in tried if one.label[1] not in FLEXIBLE and better(one, choice.best)]
    plain = [one for one in plain if relevant(fitting, one, choice)]
    return [*plain[:1], *(one for one in tried if not plain or one is not plain[0])]


def _told(fitting: Fitting, base: Fitted) -> list[Tried]:
    """The wire that its own force tells all about; none where it does not, or where singles come near."""
    found = told_wire(fitting, base) if fitting.doubt > WRONG else None
    if found is None:
        return []
    start, model = found
    fitting.told[start.added.place] = start.added.kind
    return [
        one for one in [fit_further(fitting, unfitted(start, base, model), None, 1)] if np.isfinite(one.error)
    ]


def _settled(fitting: Fitting, choice: Choice, best: Tried, known: Floats, *, told: bool) -> Tried:
    """The effect that was chosen, fitted to its end where there may be more behind it."""
    lost, fitting.doubt = fitting.doubt > WRONG, doubt(fitting, best.fitted)
    if lost:
        fitting.rebase(best.fitted.model)
    if told:
        best = finished(fitting, let_go(best, choice.base))
    elif lost or fitting.doubt > UNFINISHED:
        best = finished(fitting, best, None if lost else known)
    if fitting.experiment.sharpen(best.fitted.model.spec):
        best = finished(fitting, best)
    return best
