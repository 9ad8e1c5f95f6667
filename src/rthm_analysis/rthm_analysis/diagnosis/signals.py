"""Sampled signals: what is not known filled in, and noise smoothed away."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import SINC_REACH, SINC_SHARPNESS
from rthm_core.compiled import Floats


def filled(values: Floats) -> Floats:
    """A signal with straight lines over what is not known, and zero where nothing is.

    Parameters
    ----------
    values : (s,) array
        NaN where not known.

    Returns
    -------
    (s,) array

    Examples
    --------
    >>> filled(np.array([1.0, np.nan, 3.0, np.nan])).tolist()
    [1.0, 2.0, 3.0, 3.0]
    """
    known = np.isfinite(values)
    if known.all() or not known.any():
        return np.nan_to_num(values)
    at = np.arange(values.size)
    return np.interp(at, at[known], values[known])


def smoothed(values: Floats, width: int, order: int = 0) -> Floats:
    """Value, or derivative by the sample, of the parabola around each sample (Savitzky and Golay).

    Parameters
    ----------
    values : (s,) array
    width : int
        Samples under a parabola, odd; the first and the last hold up to the ends.
    order : int
        Derivative: 0, 1 or 2.

    Returns
    -------
    (s,) array

    Examples
    --------
    >>> smoothed(np.arange(5.0) ** 2, 3, 1).round(6).tolist()
    [0.0, 2.0, 4.0, 6.0, 8.0]
    """
    # Not by scipy: its import takes longer than all that is smoothed in a diagnosis.
    width = min(width, values.size // 2 * 2 - 1)
    half = width // 2
    powers = np.vander(np.arange(-half, half + 1.0), 3, increasing=True)
    fits = np.linalg.pinv(powers)
    smooth = np.empty(values.size)
    weights = fits[order] * (2.0 if order == 2 else 1.0)
    smooth[half : values.size - half] = np.convolve(values, weights[::-1], "valid")
    for samples, at in ((slice(0, width), slice(0, half)), (slice(-width, None), slice(-half, None))):
        derivative = np.polynomial.polynomial.polyder(fits @ values[samples], order)
        smooth[at] = np.polynomial.polynomial.polyval(powers[at, 1], derivative)
    return smooth


def ahead(values: Floats, samples: float) -> Floats:
    """A signal as it is so many samples later, whole or not, with its noise no quieter.

    Straight lines between samples average their noise, most of all its fastest part, which says how loud it
    is. A sinc under a Kaiser window passes nearly all of it.

    Parameters
    ----------
    values : (s,) array
        NaN where not known.
    samples : float

    Returns
    -------
    (s,) array
        NaN where not known; cubics or straight lines where few samples around are known, as near the ends.

    Examples
    --------
    >>> wave = np.sin(0.1 * np.arange(400))
    >>> error = ahead(wave, 2.5) - np.sin(0.1 * (np.arange(400) + 2.5))
    >>> bool(np.abs(error[2:-5]).max() < 1e-5)
    True
    """
    whole, part = divmod(samples, 1.0)
    known, found = np.isfinite(values), np.full(values.size, np.nan)
    for weights in _between(part):
        first = np.arange(values.size) + int(whole) + 1 - weights.size // 2
        inside = (first >= 0) & (first + weights.size <= values.size)
        all_known = np.convolve(~known, np.ones(weights.size), "valid") < 0.5
        inside[inside] = all_known[first[inside]]
        moved = np.convolve(np.nan_to_num(values), weights[::-1], "valid")
        found[inside] = moved[first[inside]]
    return found


def _between(part: float) -> Iterator[Floats]:
    """Weights of the samples around a place that is so far behind one of them, those of few samples first."""
    yield np.array([1.0 - part, part])
    at = np.arange(-1.0, 3.0)
    yield np.array([np.prod([(part - b) / (a - b) for b in at if b != a]) for a in at])
    away = np.arange(1 - SINC_REACH, SINC_REACH + 1) - part
    window = np.i0(SINC_SHARPNESS * np.sqrt(np.maximum(1.0 - (away / SINC_REACH) ** 2, 0.0)))
    weights = np.sinc(away) * window
    yield weights / weights.sum()
