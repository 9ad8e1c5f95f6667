"""Known loads: sums of sines that fade in, kept as a table of values and slopes."""

from __future__ import annotations

import numpy as np
from numba import njit

GRID = 1e-3  # s; between its points a cubic: below 25 rad/s within 1e-9 of the amplitude


def tabulate(sines: np.ndarray, ramp: float, duration: float, start: float = 0.0) -> np.ndarray:
    """Load and its slope on the grid, shape (n, 2), in N and N/s.

    Parameters
    ----------
    sines
        Rows of amplitude (N), frequency (rad/s), phase.
    ramp
        Seconds over which the load fades in, whole milliseconds.
    duration
        Seconds that the table covers.
    start
        When the load begins to fade in, whole milliseconds, s.
    """
    t = GRID * np.arange(round(duration / GRID) + 2)
    value, slope = np.zeros_like(t), np.zeros_like(t)
    for amplitude, frequency, phase in sines:
        value += amplitude * np.sin(frequency * t + phase)
        slope += amplitude * frequency * np.cos(frequency * t + phase)
    if ramp > 0.0:
        share = np.clip((t - start) / ramp, 0.0, 1.0)
        rising = (t >= start) & (t < start + ramp)
        slope = slope * share + np.where(rising, value / ramp, 0.0)
        value *= share
    return np.stack([value, slope], axis=1)


@njit
def load(t: float, table: np.ndarray) -> float:
    """Load at time t, in N: the cubic through two values and slopes."""
    i = min(int(t / GRID), len(table) - 2)
    s = t / GRID - i
    rise = table[i + 1, 0] - table[i, 0]
    a, b = GRID * table[i, 1] - rise, rise - GRID * table[i + 1, 1]
    return (1.0 - s) * table[i, 0] + s * table[i + 1, 0] + s * (1.0 - s) * ((1.0 - s) * a + s * b)
