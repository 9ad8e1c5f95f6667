"""Spikes: one to three samples that leave their neighbours and return, which no motion does."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import (
    COMMAND_TRACE_S,
    FEW_SPIKES_SIZE_RATIO,
    SEVERAL_SPIKES,
    SEVERAL_SPIKES_MEDIAN_RATIO,
    SPIKE_BETWEEN_SHARE,
    SPIKE_BLOCK,
    SPIKE_CALM_SAMPLES,
    SPIKE_CALM_SHARE,
    SPIKE_EXPLAINED_SHARE,
    SPIKE_LARGEST_LOG_HEIGHT,
    SPIKE_LEAST_STD_RATIO,
    SPIKE_MOST_SAMPLES,
    SPIKE_NEIGHBOURS,
    SPIKE_RETURN_SHARE,
    SPIKE_TAIL_EXPECTED,
    SPIKE_TAIL_SHARE,
    SPIKE_TO_COARSE_STEP,
    SPIKE_TO_LARGE_STEPS,
    SPIKE_TO_USUAL_BEND,
    SPIKE_TO_USUAL_DISTANCE,
    SPIKES_MOST_SHARE,
)
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.stretches import (
    Stretch,
    flagged,
    grain,
    held_commands,
    stretches,
    whole_interval,
    without,
)
from rthm_analysis.diagnosis.numbers import instants
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.diagnosis.signals import filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


def find_spikes(evidence: Evidence) -> tuple[Evidence, list[Fault]]:
    """Leave out the spikes of all channels, and tell them.

    Motor and force follow the commands, and the force follows the motor: what these do at the same time is
    no fault of the sensor behind them. An acceleration that leaves its neighbours may be an impact.

    Returns
    -------
    Evidence
        NaN in place of the spikes.
    list of Fault
        One for each channel that has some.
    """
    faults = []
    seen = evidence
    for column, channel in enumerate(seen.channels):
        found = [] if channel.family == "acceleration" else _spikes(seen.measured[:, column])
        if found and channel.family in ("force", "motor"):
            real = np.maximum(
                _passed_on(seen, column), SPIKE_TO_LARGE_STEPS * _busy(filled(seen.measured[:, column]))
            )
            found = [one for one in found if _size(seen, column, one) > real[one[0] : one[1]].max()]
        if found:
            faults.append(_fault(seen, column, found))
            evidence = without(evidence, column, found)
    return evidence, faults


def _passed_on(evidence: Evidence, column: int) -> Floats:
    """Largest excursion of motor or force (s,), in its unit, that excursions before it explain."""
    channel, values = evidence.channels[column], filled(evidence.measured[:, column])
    causes = []
    if evidence.driven_by == "command":
        causes += list(held_commands(evidence).T)
    if channel.family == "force":
        motors = [i for i, one in enumerate(evidence.channels) if one.family == "motor"]
        causes += [filled(evidence.measured[:, i]) for i in motors]
    size = np.zeros(values.size)
    for cause in causes:
        gain = _busy(values) / max(_busy(cause), 1e-300) if channel.family == "force" else 1.0
        size = np.maximum(size, gain * _lasting(_excursions(cause), evidence))
    return size / SPIKE_EXPLAINED_SHARE


def _busy(values: Floats) -> float:
    """Size of the large steps from sample to sample."""
    return float(np.quantile(np.abs(np.diff(values)), 0.98))


def _lasting(size: Floats, evidence: Evidence) -> Floats:
    """Largest value a little after and up to `COMMAND_TRACE_S` before each sample."""
    step = max(float(np.median(np.diff(evidence.time))), 1e-9)
    largest = np.pad(size, (int(np.ceil(COMMAND_TRACE_S / step)), SPIKE_MOST_SAMPLES))
    reach, done = largest.size - size.size + 1, 1
    while done < reach:
        by = min(done, reach - done)
        largest = np.maximum(largest[:-by], largest[by:])
        done += by
    return largest


def _excursions(values: Floats) -> Floats:
    """How far each sample is from the median of itself and four neighbours."""
    reach = max(SPIKE_NEIGHBOURS)
    around = np.pad(values, reach, mode="edge")
    moved = [
        around[reach + by : reach + by + values.size]
        for by in (0, *SPIKE_NEIGHBOURS, *(-r for r in SPIKE_NEIGHBOURS))
    ]
    return np.asarray(np.abs(values - np.sort(np.stack(moved), axis=0)[len(SPIKE_NEIGHBOURS)]))


def _usual(size: Floats, part: float) -> Floats:
    """What so many of the samples in the block of each and in the blocks beside it do not exceed."""
    count = max(size.size // SPIKE_BLOCK, 1)
    shorter, longer = divmod(size.size, count)
    parts = np.split(size, [longer * (shorter + 1)])
    alike = (parts[0].reshape(longer, shorter + 1), parts[1].reshape(count - longer, shorter))
    typical = np.concatenate([np.quantile(rows, part, axis=1) for rows in alike if rows.size])
    beside = np.pad(typical, 1, mode="edge")
    largest = np.maximum(np.maximum(beside[:-2], beside[2:]), typical)
    return np.repeat(largest, np.where(np.arange(count) < longer, shorter + 1, shorter))


def _spikes(values: Floats) -> list[Stretch]:
    """Spikes of one signal."""
    known = np.isfinite(values)
    if np.count_nonzero(known) < SPIKE_BLOCK:
        return []
    whole = filled(values)
    size, spread = _excursions(whole), float(np.std(whole))
    steps = grain(whole)
    second = np.abs(np.diff(whole, 2, prepend=whole[0], append=whole[-1]))
    least = np.maximum(
        SPIKE_TO_USUAL_DISTANCE * _usual(size, 0.9), SPIKE_TO_USUAL_BEND * _usual(second, 0.75)
    )
    least = np.maximum(least, max(SPIKE_TO_COARSE_STEP * steps, SPIKE_LEAST_STD_RATIO * spread, 1e-300))
    found = [
        one
        for one in stretches((size > least) & known)
        if one[1] - one[0] <= SPIKE_MOST_SAMPLES and _returns(whole, one, float(size[one[0] : one[1]].max()))
    ]
    middling = int(np.count_nonzero((size > SPIKE_BETWEEN_SHARE * least) & (size <= least) & known))
    heights = [float((size / least)[a:b].max()) for a, b in found]
    if len(found) < SEVERAL_SPIKES:
        rare = max(
            FEW_SPIKES_SIZE_RATIO,
            _reach_of_tail(np.delete(size / least, np.flatnonzero(flagged(found, size.size)))),
        )
        found = [one for one, height in zip(found, heights, strict=True) if height > rare]
    elif np.median(heights) > SEVERAL_SPIKES_MEDIAN_RATIO:
        middling = 0
    return found if 2 * middling <= len(found) <= SPIKES_MOST_SHARE * values.size else []


def _reach_of_tail(heights: Floats) -> float:
    """Height beyond which excursions are hardly expected: a power law through the largest of them."""
    tail = np.log(
        np.maximum(np.sort(heights)[-max(int(SPIKE_TAIL_SHARE * heights.size), SEVERAL_SPIKES) :], 1e-300)
    )
    reach = float(tail[0] + np.mean(tail - tail[0]) * np.log(tail.size / SPIKE_TAIL_EXPECTED))
    return float(np.exp(min(reach, SPIKE_LARGEST_LOG_HEIGHT)))


def _returns(values: Floats, one: Stretch, size: float) -> bool:
    """Whether the signal is back after it where it was before, and was calm there."""
    before = values[max(one[0] - SPIKE_CALM_SAMPLES, 0) : one[0]]
    after = values[one[1] : one[1] + SPIKE_CALM_SAMPLES]
    if not before.size or not after.size:
        return False
    calm = max(float(np.ptp(before)), float(np.ptp(after)))
    apart = abs(float(np.median(before) - np.median(after)))
    return apart < SPIKE_RETURN_SHARE * size and calm < SPIKE_CALM_SHARE * size


def _size(evidence: Evidence, column: int, one: Stretch) -> float:
    """How far a spike reaches from what is around it."""
    values = evidence.measured[:, column]
    around = np.nanmedian(values[max(one[0] - 6, 0) : one[1] + 6])
    return float(np.abs(values[one[0] : one[1]] - around).max())


def _fault(evidence: Evidence, column: int, found: list[Stretch]) -> Fault:
    channel = evidence.channels[column]
    size = max(_size(evidence, column, one) for one in found)
    span = whole_interval(evidence, found)
    first, last = instants(*span)
    when = f"at {first}" if len(found) == 1 else f"between {first} and {last}"
    many = "one spike" if len(found) == 1 else f"{len(found)} spikes"
    words = (
        f"{in_words(channel, first=True)} has {many} of up to {size:.3g} {UNIT_OF[channel.family]}, {when}: "
        "single samples that leave their neighbours and return. They are left out; check cable, shielding "
        "and connectors of this sensor."
    )
    return fault_of(channel, "spikes", words, span, float(len(found)))
