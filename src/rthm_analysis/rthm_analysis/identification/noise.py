"""Noise of a sensor at rest: its fastest part, which no motion of a machine makes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

SPREAD = 1.07
"""Relative standard deviation of the estimate, times the root of the number of samples, for white noise."""


def noise_at_rest(values: Floats) -> tuple[float, float]:
    """Standard deviation of white noise on samples (s,), and how well it is known.

    Third differences are taken, as no slow motion shows in them.
    """
    third = np.diff(values[np.isfinite(values)], 3) / np.sqrt(20.0)
    if third.size < 10:
        return float("nan"), float("nan")
    level = float(np.sqrt(np.mean(np.square(third))))
    return level, level * SPREAD / np.sqrt(third.size)
