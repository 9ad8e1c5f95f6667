"""Motion without the noise of its sensor, and its rate."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

WIDEST_RANGE = (-6.0, 30.0)
"""Logarithms of the weights of smoothness that are tried."""


class Smoothed(NamedTuple):
    """A signal (s,) without its noise, its rate per sample, and the standard deviation of the noise."""

    values: Floats
    rates: Floats
    noise: float


def smooth_motion(t: Floats, x: Floats | None, v: Floats | None) -> tuple[Floats, Floats]:
    """Position and velocity at even instants, from whichever was recorded.

    Parameters
    ----------
    t : (s,) array
        Even instants, s.
    x, v : (s,) arrays or None
        Recorded position, m, and velocity, m/s.

    Raises
    ------
    InputError
        If neither was recorded, or nothing moves.
    """
    moving = [one for one in (x, v) if one is not None and np.ptp(one) > 0.0]
    if not moving:
        raise InputError("The component does not move in this recording; record one in which it does.")
    step = float(t[1] - t[0])
    rate = None if v is None else smoothed(v).values
    if x is None:
        assert rate is not None
        path = np.concatenate([[0.0], np.cumsum(0.5 * step * (rate[1:] + rate[:-1]))])
        return path - path.mean(), rate
    found = smoothed(x)
    return found.values, found.rates / step if rate is None else rate


def smoothed(values: Floats) -> Smoothed:
    """A signal without noise, and its rate without differences of noisy samples.

    Least squares with a weight on the third differences, as large as generalised cross-validation wants it:
    on even samples a filter, and sums of sines make it one product (Garcia, Computational Statistics & Data
    Analysis 54, 2010). The signal goes on as its own point reflection beyond both ends.

    Examples
    --------
    >>> found = smoothed(np.arange(8.0))
    >>> found.rates.round(6).tolist()
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    from scipy.fft import dct, dst
    from scipy.optimize import minimize_scalar

    count = values.size - 1
    line = np.linspace(values[0], values[-1], values.size)
    sines = dst((values - line)[1:-1], 1) / count
    angle = np.pi * np.arange(1, count) / count
    rough = (2.0 - 2.0 * np.cos(angle)) ** 3

    def score(weight: float) -> float:
        lost = 1.0 - 1.0 / (1.0 + np.exp(weight) * rough)
        return float(np.log(np.sum(np.square(lost * sines)) + 1e-300) - 2.0 * np.log(np.sum(lost)))

    best = minimize_scalar(score, bounds=WIDEST_RANGE, method="bounded").x
    passed = 1.0 / (1.0 + np.exp(best) * rough)
    left = np.linalg.norm((1.0 - passed) * sines) * np.sqrt(0.5 * count)
    noise = float(left / np.sqrt(max(float(np.sum(1.0 - passed)), 1.0)))
    sines = sines * passed
    rates = dct(np.concatenate([[0.0], 0.5 * sines * angle, [0.0]]), 1)
    kept = line.copy()
    kept[1:-1] += 0.5 * dst(sines, 1)
    return Smoothed(kept, rates + (values[-1] - values[0]) / count, noise)
