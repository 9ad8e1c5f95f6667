"""Sampled signals: what is not known filled in, and noise smoothed away."""

from __future__ import annotations

import numpy as np

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
