"""Stuck sensors: one value again and again, bit by bit, while the rig moves on.

A rig that rests repeats values, too, and so do coarse sensors, slack wires and motors at their limit. So a
stretch of one value is called stuck only if the signal leaves it with a jump that nothing else makes, or if
another channel of the same dof moves meanwhile.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import (
    ALIVE_CHANGE_RATIO,
    FEWEST_KNOWN_SHARE,
    HELD_FEWEST_STRETCHES,
    NOISY_ALTERNATING_SHARE,
    PADDED_SAMPLES,
    STUCK_FEWEST_SAMPLES,
    STUCK_LEAP_RATIO,
    STUCK_LEAP_RATIO_WITHOUT_NOISE,
    STUCK_MOST_SHARE,
    STUCK_NEIGHBOURS,
    STUCK_RATE_SAMPLES,
    STUCK_SHORT_S,
    STUCK_SINGLE_SHARE,
    STUCK_TO_USUAL_LENGTH,
    STUCK_TRAVEL_SHARE,
)
from rthm_analysis.diagnosis.faults.commanded import is_real, told_to
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.stretches import (
    Stretch,
    interval,
    pieces,
    whole_interval,
    without,
)
from rthm_analysis.diagnosis.numbers import instants
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.diagnosis.signals import filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


def find_stuck(evidence: Evidence) -> tuple[Evidence, list[Fault]]:
    """Leave out the stretches in which a sensor was stuck, and tell them."""
    faults = []
    seen = evidence
    for column, channel in enumerate(seen.channels):
        found = _stuck(seen, column)
        if not found:
            continue
        kind, words = _said(seen, column, found)
        faults.append(fault_of(channel, kind, words, whole_interval(seen, found)))
        evidence = without(evidence, column, found)
    return evidence, faults


def _stuck(evidence: Evidence, column: int) -> list[Stretch]:
    values = evidence.measured[:, column]
    if (
        np.count_nonzero(np.isfinite(values)) < FEWEST_KNOWN_SHARE * values.size
        or not np.nanstd(values) > 0.0
    ):
        return []
    begin, length = pieces(values)
    long = np.flatnonzero(length >= STUCK_FEWEST_SAMPLES)
    if not _hardly_repeats(length, long):
        long = np.flatnonzero(
            length >= max(STUCK_FEWEST_SAMPLES, STUCK_TO_USUAL_LENGTH * float(np.quantile(length, 0.99)))
        )
    if not long.size or length[long].sum() > STUCK_MOST_SHARE * values.size:
        return []
    noisy = carries_noise(values, length, long)
    others = _others(evidence, column)
    found = [(int(begin[i]), int(begin[i] + length[i])) for i in long]
    return [one for one in found if _is_stuck(evidence, column, one, noisy, others)]


def carries_noise(values: Floats, length: np.ndarray, long: np.ndarray) -> bool:
    """Whether hardly a value repeats by chance, and neighbours scatter."""
    third = np.diff(values, 3)
    third = third[np.isfinite(third) & (third != 0.0)]
    return bool(
        _hardly_repeats(length, long)
        and third.size
        and np.mean(third[1:] * third[:-1] < 0.0) > NOISY_ALTERNATING_SHARE
    )


def _hardly_repeats(length: np.ndarray, long: np.ndarray) -> bool:
    """Whether nearly all values but those of long stretches are unlike their neighbours."""
    return bool(np.count_nonzero(length == 1) >= STUCK_SINGLE_SHARE * (length.size - long.size))


def _is_stuck(evidence: Evidence, column: int, one: Stretch, noisy: bool, others: list[Floats]) -> bool:
    values, family = evidence.measured[:, column], evidence.channels[column].family
    held = float(values[one[0]])
    if not np.isfinite(held) or one[0] == 0:
        return False
    extreme = held in (float(np.nanmax(values)), float(np.nanmin(values)))
    moving = any(_travels(other, one) for other in others)
    if noisy:
        if extreme or (held == 0.0 and (family == "force" or is_real(evidence, column, one))):
            return False
        leaps = _leaps(values, one, STUCK_LEAP_RATIO) and not told_to(evidence, column, one)
        return moving or leaps or _alive_around(values, one)
    if extreme or family not in ("position", "velocity"):
        return False
    return moving or (family == "position" and _leaps(values, one, STUCK_LEAP_RATIO_WITHOUT_NOISE))


def _leaps(values: Floats, one: Stretch, clear: float) -> bool:
    """Whether a stretch ends with a jump that the steps around it do not know."""
    a, b = one
    if b >= values.size:
        return False
    changes = np.abs(np.diff(values))
    around = np.concatenate(
        [changes[max(a - STUCK_NEIGHBOURS, 0) : max(a - 1, 0)], changes[b : b + STUCK_NEIGHBOURS]]
    )
    around = around[np.isfinite(around)]
    usual = float(np.nanquantile(changes, 0.99))
    largest = max(float(around.max(initial=0.0)), usual)
    return bool(changes[b - 1] > clear * largest > 0.0)


def _alive_around(values: Floats, one: Stretch) -> bool:
    """Whether samples change as usual right before a stretch and right after it: no rig comes to rest so."""
    a, b = one
    if b >= values.size and b - a < PADDED_SAMPLES:
        return False
    changes = np.abs(np.diff(values))
    usual = ALIVE_CHANGE_RATIO * float(np.nanmedian(changes))
    before, after = changes[max(a - STUCK_NEIGHBOURS, 0) : max(a - 1, 0)], changes[b : b + STUCK_NEIGHBOURS]
    known = [side[np.isfinite(side)] for side in (before, after) if side.size]
    return bool(known) and all(side.size and float(np.median(side)) > usual for side in known)


def _others(evidence: Evidence, column: int) -> list[Floats]:
    """Signals that change whenever this channel should: of the same dof, or of the same motor."""
    channel = evidence.channels[column]
    at = {(one.family, one.place): i for i, one in enumerate(evidence.channels)}
    if channel.family == "position" and ("velocity", channel.place) in at:
        speed = filled(evidence.measured[:, at["velocity", channel.place]])
        steps = np.diff(evidence.time, prepend=evidence.time[0])
        return [np.cumsum(speed * steps)]
    if channel.family == "velocity" and ("position", channel.place) in at:
        return [_rate(evidence, at["position", channel.place])]
    return []


def _rate(evidence: Evidence, column: int) -> Floats:
    """Rate of a position, over enough samples for its noise not to matter."""
    values = filled(evidence.measured[:, column])
    reach = STUCK_RATE_SAMPLES
    rate = np.zeros_like(values)
    span = evidence.time[2 * reach :] - evidence.time[: -2 * reach]
    rate[reach:-reach] = (values[2 * reach :] - values[: -2 * reach]) / np.maximum(span, 1e-12)
    return rate


def _travels(other: Floats, one: Stretch) -> bool:
    """Whether another signal changes by a good part of its range over a stretch."""
    part = other[one[0] + STUCK_RATE_SAMPLES : one[1] - STUCK_RATE_SAMPLES]
    if part.size < 2:
        return False
    low, high = np.quantile(other, [0.05, 0.95])
    span = max(float(high - low), 2.0 * float(np.std(other)))  # a rig that mostly rests has no range
    return bool(np.ptp(part) > STUCK_TRAVEL_SHARE * span > 0.0)


def _said(evidence: Evidence, column: int, found: list[Stretch]) -> tuple[str, str]:
    """Kind of a fault and its words."""
    channel = evidence.channels[column]
    name, unit = in_words(channel), UNIT_OF[channel.family]
    first, last = instants(*whole_interval(evidence, found))
    if not evidence.measured[[a for a, _ in found], column].any():
        return "dropout", (
            f"{in_words(channel, first=True)} is exactly 0 from {first} to {last}, in "
            f"{len(found)} stretches: the sensor or its link gave nothing there. Left out; record what is "
            "missing as NaN."
        )
    if len(found) == 1:
        value = evidence.measured[found[0][0], column]
        return "stuck", (
            f"From {first} to {last} {name} repeats one value, {value:.4g} {unit}, while the rig "
            "moves: the sensor was stuck. This stretch is left out; check the sensor and its link."
        )
    longest = max(b - a for a, b in (interval(evidence, one) for one in found))
    where = f"in {len(found)} stretches of up to {longest:.3g} s between {first} and {last}"
    if len(found) >= HELD_FEWEST_STRETCHES and longest < STUCK_SHORT_S:
        return "dropout", (
            f"{in_words(channel, first=True)} holds its last value {where}: samples are missing. They are "
            "left out; record what is missing as NaN."
        )
    return "stuck", (
        f"{in_words(channel, first=True)} repeats one value {where}, while the rig moves: the sensor was "
        "stuck. These stretches are left out; check the sensor and its link."
    )
