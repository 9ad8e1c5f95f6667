"""Sensors whose range ends before the signal does: the same largest value again and again, bit by bit.

Noise makes every reading of a signal another one. One that is the largest of all, or the smallest, and
repeats is the end of a range, which no stop, no friction and no motor at its limit can make.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import (
    FEWEST_KNOWN_SHARE,
    RANGE_END_FEWEST_READINGS,
    RANGE_END_MOST_SHARE,
    RANGE_END_STDS,
)
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.stretches import (
    Flags,
    interval,
    pieces,
    stretches,
    whole_interval,
    without,
)
from rthm_analysis.diagnosis.faults.stuck import carries_noise
from rthm_analysis.diagnosis.numbers import instants
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF, Evidence
from rthm_analysis.diagnosis.replay.readings import lattice, noise_level
from rthm_analysis.diagnosis.result import Fault

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

SATURATED = "saturation"


def find_clipped(evidence: Evidence) -> tuple[Evidence, list[Fault]]:
    """Leave out the readings at the ends of a sensor's range, and tell them."""
    seen, faults = evidence, []
    for column, channel in enumerate(seen.channels):
        if channel.family == "motor":
            continue
        values = seen.measured[:, column]
        ends = _ends(values)
        if channel.family == "force" and ends and max(np.abs(ends)) < np.nanmax(np.abs(values)):
            continue  # a slack wire has a smallest force of its own
        if not ends:
            continue
        at = np.isin(values, ends)
        noise = noise_level(np.where(at, np.nan, values), values)
        near = np.min([np.abs(values - end) for end in ends], axis=0) < RANGE_END_STDS * noise
        faults.append(_told(seen, column, at, ends))
        evidence = without(evidence, column, stretches(near))
    return evidence, faults


def _ends(values: Floats) -> list[float]:
    """Ends of the range at which a signal with noise was cut."""
    known = values[np.isfinite(values)]
    if known.size < FEWEST_KNOWN_SHARE * values.size or not np.ptp(known) > 0.0:
        return []
    ends = [end for end in (float(known.min()), float(known.max())) if _repeats(values, end)]
    free = known[~np.isin(known, ends)]
    if not ends or free.size < (1.0 - RANGE_END_MOST_SHARE) * known.size or lattice(free) is not None:
        return []
    _, length = pieces(free)
    return ends if carries_noise(free, length, np.empty(0, dtype=int)) else []


def _repeats(values: Floats, end: float) -> bool:
    """Whether a signal was at some value often, comes to it, and leaves it again."""
    at: Flags = values == end
    inner = [(a, b) for a, b in stretches(at) if a > 0 and b < values.size]
    return end != 0.0 and sum(b - a for a, b in inner) >= RANGE_END_FEWEST_READINGS and len(inner) > 1


def _told(evidence: Evidence, column: int, at: Flags, ends: list[float]) -> Fault:
    channel, found = evidence.channels[column], stretches(at)
    largest = max(ends, key=abs)
    span = whole_interval(evidence, found)
    first, last = instants(*span)
    longest = max(b - a for a, b in (interval(evidence, one) for one in found))
    values = " and ".join(f"{end:.4g}" for end in ends)
    words = (
        f"{in_words(channel, first=True)} goes no further than {values} {UNIT_OF[channel.family]}, where it "
        f"stays bit by bit in {len(found)} stretches of up to {longest:.3g} s between {first} and "
        f"{last}: the range of the sensor or of its amplifier ends there. These stretches are left "
        "out; give it more range."
    )
    return fault_of(channel, SATURATED, words, span, largest)
