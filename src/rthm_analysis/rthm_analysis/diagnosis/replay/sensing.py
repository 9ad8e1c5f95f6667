"""What effects change of the reading of a replayed signal: smoothing, gain, offset and its growth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.replay.compiled import compiled
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_core.spec.schema import EffectSpec


def time_constant(effects: list[EffectSpec]) -> float:
    """Time constant (s) of the effects on one sensor; 0: none of them lags."""
    return sum(size for one, size in _sizes(effects) if one.law.changes == "smoothing")


def sensed(time: Floats, reading: Floats, effects: list[EffectSpec]) -> Floats:
    """Reading (s,) of a sensor at the instants `time` (s), without noise, from what it lags behind to."""
    value = reading
    for one, size in _sizes(effects):
        if one.law.changes == "gain":
            value = value * size
    for one, size in _sizes(effects):
        if one.law.changes == "offset":
            value = value + size
        elif one.law.changes == "growth":
            value = value + size * time
    return value


def levelled(reading: Floats, measured: Floats, recordings: Sequence[slice], seen: int) -> Floats:
    """Reading (s,) with the constant that brings it nearest to what was measured (s,) in each recording.

    Only the first `seen` samples tell that constant, but for recordings that begin behind them.
    """
    value = reading.copy()
    for one in recordings:
        told = slice(one.start, min(one.stop, seen) if one.start < seen else one.stop)
        known = np.isfinite(measured[told])
        if known.any():
            value[one] += np.mean((measured[told] - reading[told])[known])
    return value


def _sizes(effects: list[EffectSpec]) -> Iterator[tuple[EffectSpec, float]]:
    """Effects of one sensor, each with its one number."""
    for one in effects:
        yield one, next(iter(one.numbers.values()))


def lagged(time: Floats, signal: Floats, time_constant: float) -> Floats:
    """First-order lag of a signal that runs along parabolas, and jumps where one ends.

    Parameters
    ----------
    time : (g,) array
        Start of each interval, s; it ends where the next one starts.
    signal : (g, 3) array
        At the start, middle and end of each interval.
    time_constant : float
        s.

    Returns
    -------
    (g,) array
        At the start of each interval.
    """
    out = np.empty(time.size)
    _lag_into(out, time, signal, time_constant)
    return out


@compiled
def _lag_into(out: Floats, time: Floats, signal: Floats, time_constant: float) -> None:
    out[0] = signal[0, 0]
    for g in range(time.size - 1):
        first, middle, last = signal[g]
        h = time[g + 1] - time[g]
        slope, curve = (4.0 * middle - 3.0 * first - last) / h, 2.0 * (first - 2.0 * middle + last) / h**2
        begin = first - time_constant * (slope - 2.0 * time_constant * curve)
        end = last - time_constant * (slope + 2.0 * curve * (h - time_constant))
        out[g + 1] = end + (out[g] - begin) * np.exp(-h / time_constant)
