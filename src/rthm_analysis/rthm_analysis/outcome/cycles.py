"""Energy that the errors of a loop put into each cycle of its motion."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats

FEWEST_CYCLES = 3.0
"""Cycles from which an average over them says something."""


def energy_per_cycle(t: Floats, work: Floats, motion: Floats) -> float | None:
    """Mean work in each cycle, J; + where it is put in, None where the motion has too few cycles.

    Parameters
    ----------
    t : (n,) array
        Equally spaced but for jitter, s.
    work : (n,) array
        Since the start, J.
    motion : (n,) array
        Its strongest frequency is what counts as a cycle.

    Examples
    --------
    >>> t = np.linspace(0.0, 10.0, 2001)
    >>> round(energy_per_cycle(t, -0.5 * t, np.sin(2.0 * np.pi * t)), 3)
    -0.5
    """
    known = np.isfinite(work) & np.isfinite(motion)
    t, work, motion = t[known], work[known], motion[known]
    if t.size < 8 or not np.ptp(motion):
        return None
    strength = np.abs(np.fft.rfft((motion - motion.mean()) * np.hanning(t.size)))
    peak = int(np.argmax(strength[1:-1])) + 1
    left, middle, right = strength[peak - 1 : peak + 2]
    beside = 0.5 * (left - right) / (left - 2.0 * middle + right) if peak > 1 else 0.0
    cycles = (peak + beside) * (t.size - 1) / t.size
    return float((work[-1] - work[0]) / cycles) if cycles >= FEWEST_CYCLES else None
