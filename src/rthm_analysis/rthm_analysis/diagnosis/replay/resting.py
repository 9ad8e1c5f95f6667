"""Whether a signal rests: it then shows nothing but the noise of its sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import REST_FEWEST_SAMPLES, REST_NOISE_RATIO
from rthm_analysis.diagnosis.replay.readings import fast_noise, lattice

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


def rests(values: Floats, begin: int) -> bool:
    """Whether a signal does not move from some sample on beyond its noise, or the step of its sensor.

    Parameters
    ----------
    values : (s,) array
        Position or velocity; NaN where it is not known.
    begin : int
    """
    known = values[begin:][np.isfinite(values[begin:])]
    if known.size < REST_FEWEST_SAMPLES:
        return False
    noise = max(fast_noise(known), lattice(values) or 0.0)
    return bool(known.std() <= REST_NOISE_RATIO * noise)


def rest_begin(values: Floats, known: int) -> int:
    """First sample from which on a signal (s,) rests, where it does from a `known` one."""
    low, high = 0, known
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if rests(values, middle) else (middle, high)
    return high
