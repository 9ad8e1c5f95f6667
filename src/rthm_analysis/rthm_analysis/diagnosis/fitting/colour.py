"""Coloured sensor noise: white noise and a part that forgets with a time constant, and how to whiten it.

A sensor that wanders errs alike in neighbouring samples. Weighed as white noise, such errors look like
physics. Above the frequencies at which the rig moves, the spectrum tells: white noise is flat, noise of a
time constant falls with the square of the frequency, and what a smooth motion leaves falls far faster.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numba
import numpy as np

from rthm_core.compiled import Floats, Integers

FEWEST = 400
"""Samples from which a spectrum says anything."""

BANDS = 40
"""Bands of the spectrum, evenly spaced in the logarithm of the frequency."""

FEWEST_LINES = 4
"""Lines of the spectrum in the narrowest band: its power is then known to a half."""

MOVES = 4.0
"""Power of the recording over that of the residual from which a band shows the rig's motion."""

LOUDEST = 0.05
"""Standard deviation of the coloured part over that of the recording, above which it is no noise of a sensor."""

CORNERS = np.geomspace(3e-4, 1.0, 28)
"""Corner frequencies of the coloured part that are tried, in radians per sample."""

UNSURE = 0.03
"""Relative error of a band's power that is not chance, as from a slightly wrong shape."""

CLEARER = 25.0
"""Squared misfit that a coloured part must explain to be taken: far beyond chance for two parameters."""

AS_GOOD = 4.0
"""Squared misfit within which the longest memory is taken: what may be noise is no physics."""

LEAST = 0.05
"""Part of the white noise that the coloured part must add in some band, to matter."""


@dataclass(frozen=True)
class Colour:
    """Noise of a channel as an autoregressive process beside white noise, in innovations form.

        y[t] - pole y[t-1] = e[t] - zero e[t-1],    e white

    Attributes
    ----------
    pole, zero : float
        Both 0: white.
    innovation : float
        Standard deviation of e, in the channel's unit.
    level : float
        Standard deviation of the noise as a whole, in the channel's unit.
    """

    pole: float
    zero: float
    innovation: float
    level: float

    @property
    def is_white(self) -> bool:
        """Whether there is nothing to whiten."""
        return self.pole == 0.0

    def memory(self, step: float) -> float:
        """Time constant in s of the coloured part, sampled every `step` s; 0: white."""
        return 0.0 if self.is_white else -step / float(np.log(self.pole))


def white(level: float) -> Colour:
    """White noise of a standard deviation."""
    return Colour(0.0, 0.0, level, level)


def colour_of(residual: Floats, measured: Floats, level: float) -> Colour:
    """Colour of the noise of one channel.

    Parameters
    ----------
    residual : (s,) array
        Measured minus simulated, NaN where not known; smooth mismatch does not matter.
    measured : (s,) array
        What was recorded; tells in which bands the rig moves.
    level : float
        Standard deviation of the white part as the fastest differences show it; returned where all is white.

    Examples
    --------
    >>> colour_of(np.random.default_rng(0).normal(size=5000), np.sin(np.arange(5000) / 50), 1.0).is_white
    True
    """
    if residual.size < FEWEST:
        return white(level)
    at, power, lines = _banded(*spectrum(residual))
    moving = np.flatnonzero(_banded(*spectrum(measured))[1] > MOVES * power)
    found = _parts(at, power, lines, np.arange(at.size) <= moving.max(initial=-1))
    if found is None:
        return white(level)
    colour = _innovations(*found)
    colour = replace(colour, level=min(colour.level, float(np.nanstd(residual))))
    return colour if colour.level < LOUDEST * float(np.nanstd(measured)) else white(level)


def spectrum(signal: Floats) -> tuple[Floats, Floats]:
    """Frequencies in radians per sample, and power of a signal there: 1 for white noise of power 1."""
    known = np.isfinite(signal)
    at = np.arange(signal.size)
    even = signal if known.all() else np.interp(at, at[known], signal[known])
    taper = np.hanning(signal.size)
    lines = np.fft.rfft((even - even.mean()) * taper)[1:]
    return np.pi * np.arange(1, lines.size + 1) / lines.size, np.abs(lines) ** 2 / float(taper @ taper)


def _banded(omega: Floats, power: Floats) -> tuple[Floats, Floats, Floats]:
    """Middle, mean power and number of lines of each band."""
    edges = np.geomspace(omega[0] * 0.99, omega[-1] * 1.001, BANDS + 1)
    number = np.searchsorted(edges, omega, side="right") - 1
    count = np.bincount(number, minlength=BANDS).astype(float)
    used = count >= FEWEST_LINES
    mean = np.bincount(number, power, BANDS)[used] / count[used]
    return np.bincount(number, omega, BANDS)[used] / count[used], mean, 0.5 * count[used]


def _parts(at: Floats, power: Floats, lines: Floats, moving: np.ndarray) -> tuple[float, float, float] | None:
    """White power, drive of the coloured part per sample, and its corner; None: all is white.

    What the model leaves in the bands in which the rig moves may be anything on top of the noise.
    """
    from scipy.optimize import nnls

    weight = 1.0 / (power * (UNSURE + np.sqrt(1.0 / lines)))
    free = np.flatnonzero(moving)
    own = np.zeros((at.size, free.size))
    own[free, np.arange(free.size)] = 1.0
    tail = np.where(moving, 0.0, (at / at[-1]) ** -6.0)
    base = np.column_stack([np.ones_like(at), *([tail] if tail.any() else []), own])
    columns = base * weight[:, None]
    plain = float(nnls(columns / columns.max(0), power * weight)[1])
    fits = [_with_corner(at, base, weight, power, corner) for corner in CORNERS.tolist()]
    best = min(misfit for misfit, _, _ in fits)
    if plain**2 - best**2 < CLEARER:
        return None
    as_good = next(i for i, (misfit, _, _) in enumerate(fits) if misfit**2 < best**2 + AS_GOOD)
    _, first, drive = fits[as_good]
    corner = float(CORNERS[as_good])
    seen = drive / (2.0 - 2.0 * np.cos(at[~moving]) + corner**2)
    return (first, drive, corner) if seen.max(initial=0.0) > LEAST * first else None


def _with_corner(
    at: Floats, base: Floats, weight: Floats, power: Floats, corner: float
) -> tuple[float, float, float]:
    """Misfit of the bands with a coloured part of some corner, white power, and drive of the coloured part."""
    from scipy.optimize import nnls

    shape = 1.0 / (2.0 - 2.0 * np.cos(at) + corner**2)
    columns = np.column_stack([base, shape]) * weight[:, None]
    scale = columns.max(0)
    sizes, misfit = nnls(columns / scale, power * weight)
    return float(misfit), float(sizes[0] / scale[0]), float(sizes[-1] / scale[-1])


def _innovations(white_power: float, drive: float, corner: float) -> Colour:
    """Steady state of the filter that separates both parts."""
    pole = 1.0 / (1.0 + 0.5 * corner**2 + corner * np.sqrt(1.0 + 0.25 * corner**2))
    drive = drive * pole
    b = white_power * (pole**2 - 1.0) + drive
    known = 0.5 * (b + np.sqrt(b * b + 4.0 * drive * white_power))
    power = known + white_power
    level = float(np.sqrt(white_power + drive / (1.0 - pole**2)))
    return Colour(float(pole), float(pole * white_power / power), float(np.sqrt(power)), level)


def whitened_from(errors: Floats, colours: Sequence[Colour], starts: Integers) -> Floats:
    """Errors (s, k) with the colour of the noise of each channel taken out, from each of some samples on."""
    if all(colour.is_white for colour in colours):
        return errors
    out = errors.copy()
    for k, colour in enumerate(colours):
        if not colour.is_white:
            for begin, end in pairwise([*starts.tolist(), errors.shape[0]]):
                out[begin:end, k] = whitened(np.ascontiguousarray(errors[begin:end, k]), colour.pole, colour.zero)
    return out


@numba.njit(cache=True, nogil=True, error_model="numpy")
def whitened(values: Floats, pole: float, zero: float) -> Floats:
    """Innovations (s,) of a signal (s,) whose noise has a colour; 0 before its first sample."""
    out = np.empty_like(values)
    before, error = 0.0, 0.0
    for t in range(values.size):
        error = values[t] - pole * before + zero * error
        before = values[t]
        out[t] = error
    return out
