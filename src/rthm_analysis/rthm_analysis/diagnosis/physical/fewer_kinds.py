"""Kinds beside a formula that are hardly missed without: the formula can be bent to do what they do."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.search import GAIN_OF_CHANCE, GAIN_PER_PARAMETER
from rthm_analysis.diagnosis.criteria.verdict import CONFIRMING_GAIN, NEGLIGIBLE_SHARE
from rthm_analysis.diagnosis.physical.above_noise import without_each
from rthm_analysis.diagnosis.physical.verdict import Judgement


@np.errstate(over="ignore", invalid="ignore")  # a model that diverges is known by its error
def with_fewer_kinds(judged: Judgement) -> Judgement:
    """The same without kinds beside a formula whose gain may be chance, in data left out of the fit or in
    unseen ones, or is next to nothing of the mismatch: no name follows from what a fitted law leaves.
    """
    selection = judged.physical.selection
    kinds = len(selection.rounds) - selection.formulas
    if not (judged.earned and selection.formulas):
        return judged
    for index in reversed(range(kinds)):
        judged = _without_needless(judged, index)
    return judged


def _without_needless(judged: Judgement, index: int) -> Judgement:
    """The same without a kind, the formula fitted again, where it is hardly missed."""
    physical = judged.physical
    without = without_each(physical, [index])
    if len(without.selection.rounds) == len(physical.selection.rounds):
        return judged
    fewer = judged.of(without, composed=judged.composed)
    numbers = len(physical.selection.best.model.parameters) - len(without.selection.best.model.parameters)
    gain = without.selection.left_out - physical.selection.left_out
    shown = fewer.squares["explained"] - judged.squares["explained"]
    mismatch = judged.squares["retuned"] - judged.expected
    is_needed = is_beyond_chance(gain, shown, numbers, judged.misfit) and shown > NEGLIGIBLE_SHARE * mismatch
    return judged if is_needed or not fewer.earned else fewer


def is_beyond_chance(gain: float, shown: float, numbers: int, misfit: float) -> bool:
    """Whether a kind with some numbers gains more than chance.

    Parameters
    ----------
    gain, shown : float
        Squared error, in units of the noise, that it removes in data left out of the fit, and in unseen ones.
    numbers : int
        How many numbers of its own it has.
    misfit : float
        Error that is left, over the noise: so much larger is chance.
    """
    least = GAIN_OF_CHANCE + GAIN_PER_PARAMETER * (numbers - 1)
    return gain > least * misfit**2 and shown > CONFIRMING_GAIN * misfit**2
