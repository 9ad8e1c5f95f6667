"""Samples that a sensor or its link did not deliver: marked by NaN, or given as zero."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import (
    DROPOUT_DISTANCE_RMS,
    DROPOUT_FEWEST_SAMPLES,
    DROPOUT_JUMP_STEPS,
    DROPOUT_JUMP_TO_USUAL,
    DROPOUT_JUMPING_SHARE,
    DROPOUT_TO_USUAL_LENGTH,
    SLOW_CHANNEL_FEWEST_GAPS,
    SLOW_CHANNEL_GAP_SHARE,
)
from rthm_analysis.diagnosis.faults.commanded import is_real
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.stretches import (
    Stretch,
    grain,
    pieces,
    stretches,
    whole_interval,
    without,
)
from rthm_analysis.diagnosis.numbers import instants
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.diagnosis.signals import filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


def find_dropouts(evidence: Evidence) -> tuple[Evidence, list[Fault]]:
    """Tell gaps, and leave out zeros that stand for gaps."""
    faults = []
    for column, channel in enumerate(evidence.channels):
        values = evidence.measured[:, column]
        gaps = _gaps(values)
        if gaps:
            words = (
                f"{in_words(channel, first=True)} is missing {_when(evidence, gaps)}. Nothing is concluded "
                "from there."
            )
            told = fault_of(channel, "dropout", words, whole_interval(evidence, gaps), _lost(gaps, evidence))
            faults.append(replace(told, marked=True))
        zeros = [one for one in _zeros(values) if not is_real(evidence, column, one)]
        if zeros:
            words = (
                f"{in_words(channel, first=True)} drops to exactly 0 {_when(evidence, zeros)}, and comes "
                "back with a jump: the sensor or its link gave nothing there. Left out; record what is "
                "missing as NaN."
            )
            faults.append(
                fault_of(channel, "dropout", words, whole_interval(evidence, zeros), _lost(zeros, evidence))
            )
            evidence = without(evidence, column, zeros)
    return evidence, faults


def _gaps(values: Floats) -> list[Stretch]:
    """Stretches of NaN, unless the channel is just sampled less often."""
    missing = ~np.isfinite(values)
    found = stretches(missing)
    short = sum(b - a for a, b in found if b - a < DROPOUT_FEWEST_SAMPLES)
    if short > SLOW_CHANNEL_GAP_SHARE * values.size:
        return []
    lengths = np.array([b - a for a, b in found if b - a >= DROPOUT_FEWEST_SAMPLES])
    if (
        lengths.size > SLOW_CHANNEL_FEWEST_GAPS
        and np.ptp(lengths) <= 1
        and lengths.sum() > SLOW_CHANNEL_GAP_SHARE * values.size
    ):
        return []
    return [one for one in found if one[1] - one[0] >= DROPOUT_FEWEST_SAMPLES]


def _zeros(values: Floats) -> list[Stretch]:
    """Stretches of exact zeros into and out of which the signal jumps."""
    whole = filled(values)
    _, length = pieces(values)
    least = max(DROPOUT_FEWEST_SAMPLES, DROPOUT_TO_USUAL_LENGTH * float(np.quantile(length, 0.98)))
    found = [one for one in stretches(values == 0.0) if one[1] - one[0] >= least]
    if not found:
        return []
    size = float(np.sqrt(np.mean(np.square(whole))))
    usual = float(np.quantile(np.abs(np.diff(whole)), 0.99))
    least = max(DROPOUT_DISTANCE_RMS * size, DROPOUT_JUMP_TO_USUAL * usual, DROPOUT_JUMP_STEPS * grain(whole))
    clear = [one for one in found if _jumps(whole, one, least)]
    return found if len(clear) >= DROPOUT_JUMPING_SHARE * len(found) else clear


def _jumps(values: Floats, one: Stretch, least: float) -> bool:
    """Whether the signal is away from zero on both sides."""
    inside = one[0] > 0 and one[1] < values.size
    return inside and min(abs(values[one[0] - 1]), abs(values[one[1]])) > least


def _when(evidence: Evidence, found: list[Stretch]) -> str:
    first, last = instants(*whole_interval(evidence, found))
    if len(found) == 1:
        return f"from {first} to {last}"
    return f"in {len(found)} stretches between {first} and {last}"


def _lost(found: list[Stretch], evidence: Evidence) -> float:
    """Seconds that are missing."""
    step = float(np.median(np.diff(evidence.time)))
    return step * sum(b - a for a, b in found)
