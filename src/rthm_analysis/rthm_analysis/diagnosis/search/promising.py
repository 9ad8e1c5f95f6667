"""Choose the candidates that are worth a fit, from the score of each."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    GAIN_OF_CHANCE,
    KINDS_FROM_TWO_STARTS,
    MOST_KINDS_REFINED,
    MOST_KINDS_RESCREENED,
    PROMISING_SHARE_OF_CHANCE,
    SLOW_KIND_STARTS,
    STILL_PROMISING_SHARE,
    WORTH_A_FIT_SHARE,
    WORTH_A_FIT_SHARE_OF_CHANCE,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.search.candidates import candidates
from rthm_analysis.diagnosis.search.judging import looked_for
from rthm_analysis.diagnosis.search.screening import ScoredCandidate, best_of_each, screen
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.tones import harmonic_starts
from rthm_core.compiled import Floats
from rthm_core.errors import InputError


def screened(fitting: Fitting, fitted: Fitted, known: Floats) -> list[ScoredCandidate]:
    """Score of everything that could be added to a model, best first.

    Parameters
    ----------
    fitting : Fitting
    fitted : Fitted
        The model without it.
    known : (p, t k) array
        Its projected columns.
    """
    experiment, spec = fitting.experiment, fitted.model.spec
    motion = experiment.motion(spec, fitting.windows)
    starts = list(looked_for(fitting, candidates(spec, experiment.evidence, motion, fitting.sigma)))
    starts += tones(fitting, fitted)
    first = screen(fitting, fitted, known, starts)
    # A size far from the trial's was an extrapolation: look again from there.
    again = [
        s.start
        for s in best_of_each(first, 1)[:MOST_KINDS_RESCREENED]
        if s.gain > GAIN_OF_CHANCE and s.start.amplitude
    ]
    second = screen(fitting, fitted, known, again)
    both = sorted([*first, *second], key=lambda s: -s.gain)
    others = max((s.gain for s in both if s.start.added.block != "wire"), default=0.0)
    denied = fitting.cores.each(lambda s: _denied(fitting, fitted, s, _worth_a_fit(others)), both)
    return [s for s, no in zip(both, denied, strict=True) if not no]


def tones(fitting: Fitting, fitted: Fitted) -> Iterable[InitialGuess]:
    """Tones that what a model leaves shows."""
    if fitting.simple:
        return []
    left = fitting.residual(fitted.model).reshape(fitting.weight.shape)
    residual = np.where(fitting.weight > 0.0, left, np.nan)
    return harmonic_starts(fitted.model.spec, fitting.experiment, residual, fitting.sigma)


def _denied(fitting: Fitting, fitted: Fitted, one: ScoredCandidate, worth: float) -> bool:
    """Whether a candidate that would be fitted is a wire's and denied by the force of the wire."""
    if one.start.added.block != "wire" or one.gain <= worth:
        return False
    try:
        return fitting.wires_alone.contradict(fitted.model, one.start.added_to(fitted.model))
    except InputError:
        return False


def promising(screened: list[ScoredCandidate]) -> list[ScoredCandidate]:
    """Candidates worth a fit: those near the best in gain, the best kinds from two starts."""
    best = screened[0].gain if screened else 0.0
    if best < PROMISING_SHARE_OF_CHANCE * GAIN_OF_CHANCE:
        return []
    near = [s for s in screened if s.gain > _worth_a_fit(best)]
    firsts = best_of_each(near, 1)[:MOST_KINDS_REFINED]
    kinds = {s.start.label[:2] for s in firsts[:KINDS_FROM_TWO_STARTS]}
    chosen = list(firsts)
    for one in (*best_of_each(near, 2), *best_of_each(near, 1, "n")):
        label = one.start.label
        starts = sum(other.start.label == label for other in chosen)
        enough = starts >= SLOW_KIND_STARTS and one.start.added.law.cost > 1
        if label[:2] in kinds and one not in chosen and not enough:
            chosen.append(one)
    return chosen


def still_promising(screened: list[ScoredCandidate]) -> list[ScoredCandidate]:
    """Best start of each kind at each place, of a round before, that may be worth a fit by now."""
    return [one for one in best_of_each(screened, 1) if one.gain > STILL_PROMISING_SHARE * GAIN_OF_CHANCE]


def _worth_a_fit(best: float) -> float:
    """Gain from which a candidate is fitted, given that of the best."""
    return max(WORTH_A_FIT_SHARE_OF_CHANCE * GAIN_OF_CHANCE, WORTH_A_FIT_SHARE * best)


def smallest_seen(screened: list[ScoredCandidate]) -> dict[tuple[str, str, str], dict[str, float]]:
    """Smallest amplitudes that would have been seen, from the standard deviations of the amplitudes."""
    limits: dict[tuple[str, str, str], dict[str, float]] = {}
    for one in screened:
        if one.start.amplitude and np.isfinite(one.std):
            name = one.start.amplitude[0]
            seen = float(np.sqrt(GAIN_OF_CHANCE + one.start.look_elsewhere) * one.std)
            limits.setdefault(one.start.label, {name: seen})
    return limits
