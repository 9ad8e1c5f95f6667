"""By how much a signal is late against another, between two samples, and by how much larger it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.identification.estimate import BLOCKS, covariance

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

    from rthm_core.compiled import Floats

LONGEST, SHARE = 1.0, 0.25
"""Longest delay that is looked for, s, and over the time that there is."""

FEWEST = 4 * BLOCKS
"""Samples that an estimate takes at least."""

STEPS, NEAR = 30, 1e-12
"""Steps of the search at most, and the step that ends it, s."""


@dataclass(frozen=True)
class Estimate:
    """A number and its standard deviation, SI; NaN: not known."""

    value: float
    std: float

    def as_dict(self) -> dict[str, float]:
        """Keys of the JSON."""
        return {"value": self.value, "std": self.std}


UNKNOWN = Estimate(np.nan, np.nan)


@dataclass(frozen=True)
class Lateness:
    """How a signal follows another: ``other(t) = gain * one(t - delay) + constant + rest``.

    Attributes
    ----------
    delay : Estimate
        s, + where the other is late.
    gain : Estimate
    rest : float
        Root mean square of the rest over that of `one`.
    """

    delay: Estimate
    gain: Estimate
    rest: float

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        amplitude = Estimate(self.gain.value - 1.0, self.gain.std)
        return {"delay": self.delay.as_dict(), "amplitude_error": amplitude.as_dict(), "rest": self.rest}


NOTHING = Lateness(UNKNOWN, UNKNOWN, np.nan)


def lateness(time: Floats, one: Floats, other: Floats) -> Lateness:
    """Delay and gain of a signal against another.

    The delay of the largest cross-correlation is where the search begins. Least squares of delay, gain and
    constant end it between the samples, on the cubic spline through `one`: that is the maximum of the
    correlation coefficient. The standard deviations hold where neighbouring errors belong together
    (`identification.estimate`).

    Parameters
    ----------
    time : (n,) array
        Ascending, s.
    one, other : (n,) arrays
        At these times.

    Returns
    -------
    Lateness
        NaN where nothing moves, or fewer than `FEWEST` samples are there.

    Examples
    --------
    >>> t = np.linspace(0.0, 10.0, 1001)
    >>> found = lateness(t, np.sin(3.0 * t), 0.9 * np.sin(3.0 * (t - 0.0123)))
    >>> round(found.delay.value, 6), round(found.gain.value, 6)
    (0.0123, 0.9)
    """
    from scipy.interpolate import CubicSpline

    if time.size < FEWEST or not np.ptp(one) > 0.0 or not np.ptp(other) > 0.0:
        return NOTHING
    if np.array_equal(one, other):
        return Lateness(Estimate(0.0, 0.0), Estimate(1.0, 0.0), 0.0)
    if not (_bounded(one) and _bounded(other)):
        return NOTHING
    curve = CubicSpline(time, one)
    start = first_delay(time, one, other)
    delay = _refined(curve, time, other, start)
    return _fitted(curve, time, other, delay)


def _bounded(values: Floats) -> bool:
    """Whether squares of the values can be counted with."""
    return bool(np.abs(values).max() < 1e100)


def first_delay(time: Floats, one: Floats, other: Floats) -> float:
    """Delay of the largest cross-correlation, to a sample, s; + where `other` is late."""
    from scipy.signal import correlate, correlation_lags

    step = float(np.median(np.diff(time)))
    even = np.arange(time[0], time[-1] + 0.5 * step, step)
    a, b = (np.interp(even, time, values - values.mean()) for values in (one, other))
    lags = correlation_lags(b.size, a.size)
    allowed = np.abs(lags) * step <= min(LONGEST, SHARE * (time[-1] - time[0]))
    return float(lags[allowed][np.argmax(correlate(b, a)[allowed])] * step)


def _refined(curve: CubicSpline, time: Floats, other: Floats, start: float) -> float:
    """Delay of least squares near the `start`, by Gauss and Newton."""
    delay, reach = start, abs(start) + SHARE * (time[-1] - time[0])
    for _ in range(STEPS):
        basis, within = _basis(curve, time, delay)
        gain, step = _least_squares(basis, other[within])[:2]
        change = float(step / gain) if gain else 0.0
        if not abs(delay + change) < reach:
            return start
        delay += change
        if abs(change) < NEAR:
            break
    return delay


def _fitted(curve: CubicSpline, time: Floats, other: Floats, delay: float) -> Lateness:
    basis, within = _basis(curve, time, delay)
    found = _least_squares(basis, other[within])
    left = other[within] - basis @ found
    spread = np.sqrt(np.maximum(np.diag(covariance(basis, basis, left)), 0.0))
    size = float(np.sqrt(np.mean(np.square(curve(time[within])))))
    gain = float(found[0])
    return Lateness(
        Estimate(delay, float(spread[1] / abs(gain))) if gain else UNKNOWN,
        Estimate(gain, float(spread[0])),
        float(np.sqrt(np.mean(np.square(left)))) / size,
    )


def _least_squares(basis: Floats, values: Floats) -> Floats:
    """Numbers (p,) with which the basis (s, p) is nearest to values (s,)."""
    return np.asarray(np.linalg.lstsq(basis.T @ basis, basis.T @ values, rcond=None)[0], dtype=float)


def _basis(curve: CubicSpline, time: Floats, delay: float) -> tuple[Floats, np.ndarray]:
    """Late curve, its change with the delay and a constant (s, 3), where they are known; at which times."""
    at = time - delay
    within = (at >= time[0]) & (at <= time[-1])
    late = at[within]
    return np.column_stack([curve(late), -curve(late, 1), np.ones(late.size)]), within
