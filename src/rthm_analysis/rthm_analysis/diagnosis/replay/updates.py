"""Samples that repeat or interpolate others say nothing of their own: a logger outpaced its sensor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import (
    INTERPOLATED_PARTS,
    INTERPOLATED_SHARE,
    JUMP_BENDS_SHARE,
    KNOT_INTERVAL_RATIO,
    READINGS_FEWEST_SAMPLES,
    ROUNDED_BEND_STEPS,
    SLOW_SENSOR_MOST_CHANGES,
    SLOW_SENSOR_MOST_SAMPLES,
    SLOW_SENSOR_REGULAR_SHARE,
    STRAIGHT_BEND_RATIO,
)
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_core.compiled import Flags, Floats


def readings_only(evidence: Evidence) -> Evidence:
    """Evidence in which samples that are no readings of the sensor count as not measured, and notes."""
    measured, notes = evidence.measured.copy(), list(evidence.notes)
    motors_last = sorted(enumerate(evidence.channels), key=lambda one: one[1].family == "motor")
    for k, channel in motors_last:
        if channel.family == "motor" and len(notes) == len(evidence.notes):
            break  # a motor may stand still from command to command; it is no slow sensor by itself
        kept, way = own_readings(measured[:, k])
        if kept is not None:
            notes.append(
                f"The {channel.family} of {channel.place} has {kept.mean():.3g} readings per sample; "
                f"what was {way} between them is left out."
            )
            measured[~kept, k] = np.nan
    return (
        evidence
        if len(notes) == len(evidence.notes)
        else replace(evidence, measured=measured, notes=tuple(notes))
    )


def own_readings(values: Floats) -> tuple[Flags | None, str]:
    """Which samples (s,) are readings of their own, and what was done between them; None: all of them are."""
    if values.size < READINGS_FEWEST_SAMPLES or not np.isfinite(values).all() or values.min() == values.max():
        return None, ""
    held = _held(values)
    if held is not None:
        return held, "repeated"
    return _knots(values), "interpolated"


def _held(values: Floats) -> Flags | None:
    """First sample of each hold, where changes come at multiples of one interval."""
    changes = np.flatnonzero(np.diff(values) != 0.0) + 1
    if (
        changes.size < READINGS_FEWEST_SAMPLES // SLOW_SENSOR_MOST_SAMPLES
        or changes.size > SLOW_SENSOR_MOST_CHANGES * values.size
    ):
        return None
    gaps, counts = np.unique(np.diff(changes), return_counts=True)
    interval = int(gaps[np.argmax(counts)])
    regular = counts[gaps % interval == 0].sum() / counts.sum()
    if not 2 <= interval <= SLOW_SENSOR_MOST_SAMPLES or regular < SLOW_SENSOR_REGULAR_SHARE:
        return None
    kept = np.zeros(values.size, dtype=bool)
    kept[changes[0] % interval :: interval] = True
    return kept


def _knots(values: Floats) -> Flags | None:
    """Samples at which an interpolated recording bends."""
    change = np.diff(values, 2)
    bend = np.abs(change)
    large = float(np.quantile(bend, 0.95))
    smallest = float(np.diff(np.unique(values)).min())
    bent = bend > STRAIGHT_BEND_RATIO * large
    straight = [1.0 - part.mean() for part in np.array_split(bent, INTERPOLATED_PARTS)]
    if (
        large < ROUNDED_BEND_STEPS * smallest
        or min(straight) < INTERPOLATED_SHARE
        or max(straight) > 1.0 - 1.0 / SLOW_SENSOR_MOST_SAMPLES
    ):
        return None
    if _jumps(change, bent):
        return None
    at = np.flatnonzero(bent) + 1
    gaps = np.diff(at)
    gaps = gaps[gaps > 1]
    if gaps.size < READINGS_FEWEST_SAMPLES // SLOW_SENSOR_MOST_SAMPLES:
        return None
    if np.quantile(gaps, 0.95) > KNOT_INTERVAL_RATIO * np.quantile(gaps, 0.05):
        return None
    kept = np.zeros(values.size, dtype=bool)
    kept[at] = True
    return kept


def _jumps(change: Floats, bent: Flags) -> bool:
    """Whether most bends come in pairs to and fro: what follows held commands jumps, and an interpolated
    recording has no jumps.
    """
    beside = bent[1:] & bent[:-1]
    back = beside & (change[1:] * change[:-1] < 0.0)
    return bool(2 * np.count_nonzero(back) > JUMP_BENDS_SHARE * np.count_nonzero(bent))
