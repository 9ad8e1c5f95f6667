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

from rthm_core.compiled import Flags, Floats, Integers

FEWEST = 400
"""Samples from which a spectrum says anything."""

BANDS = 40
"""Bands of the spectrum, evenly spaced in the logarithm of the frequency."""

REWEIGHTED = 4
"""Fits of a spectrum, each weighed by the one before, until it is the likeliest."""

FAINTEST = 1e-6
"""Part of a band's power below which no fitted spectrum is taken: weights stay numbers."""

STEPS = 30
"""Steps per part in which non-negative least squares must end."""

MOVES = 4.0
"""Power of the recording over that of the residual from which a band shows the rig's motion."""

LOUDEST, LOUDER = 0.05, 1.5
"""Standard deviation of the coloured part, over those of the recording and of the white part, above both of
which it is not noise.
"""

CORNERS = np.geomspace(3e-4, 1.0, 28)
"""Corner frequencies of the coloured part that are tried, in radians per sample."""

UNSURE = 0.03
"""Relative error of a band's power that is not chance, as from a slightly wrong shape."""

CLEARER = 20.0
"""Gain of twice the log-likelihood by a coloured part that is beyond chance for two parameters."""

FITS = 2.5
"""Misfit per band, twice the log-likelihood, that noise of two parts may have: a line has more."""

AS_GOOD = 6.0
"""Loss of it with which a longer memory is taken: what may be noise is no physics."""

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


def colour_of(residual: Floats, measured: Floats, level: float, *, moves: bool = True) -> Colour:
    """Colour of the noise of one channel.

    Parameters
    ----------
    residual : (s,) array
        Measured minus simulated, NaN where not known; smooth mismatch does not matter.
    measured : (s,) array
        What was recorded; tells in which bands the rig moves.
    level : float
        Standard deviation of the white part as the fastest differences show it; returned where all is white.
    moves : bool
        Whether a motion that the model misses may be in the residual, in the bands in which the rig moves.

    Examples
    --------
    >>> colour_of(np.random.default_rng(0).normal(size=5000), np.sin(np.arange(5000) / 50), 1.0).is_white
    True
    """
    if residual.size < FEWEST:
        return white(level)
    at, power, lines = _banded(*spectrum(residual))
    if not power.all():
        return white(level)
    moving = moves & (_banded(*spectrum(measured))[1] > MOVES * power)
    found = _parts(at, power, lines, moving)
    if found is None:
        return white(level)
    colour = _innovations(*found)
    colour = replace(colour, level=min(colour.level, float(np.nanstd(residual))))
    coloured = np.sqrt(max(colour.level**2 - found[0], 0.0))
    allowed = max(LOUDEST * float(np.nanstd(measured)), LOUDER * np.sqrt(found[0]))
    return colour if coloured <= allowed else white(level)


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
    used = count > 0
    mean = np.bincount(number, power, BANDS)[used] / count[used]
    return np.bincount(number, omega, BANDS)[used] / count[used], mean, 0.5 * count[used]


def _parts(at: Floats, power: Floats, lines: Floats, moving: Flags) -> tuple[float, float, float] | None:
    """White power, drive of the coloured part per sample, and its corner; None: all is white.

    What the model leaves in the bands in which the rig moves may be anything on top of the noise.
    """
    free = np.flatnonzero(moving)
    own = np.zeros((at.size, free.size))
    own[free, np.arange(free.size)] = 1.0
    highest = at[moving].max(initial=0.0)
    tail = np.where(at > highest, (at / at[-1]) ** -6.0, 0.0)
    base = np.column_stack([np.ones_like(at), *([tail] if highest and tail.any() else []), own])
    plain, _ = _likeliest(base, power, lines)
    shapes = [1.0 / (2.0 - 2.0 * np.cos(at) + corner**2) for corner in CORNERS.tolist()]
    fits = [_likeliest(np.column_stack([base, shape]), power, lines) for shape in shapes]
    best = min(unlikely for unlikely, _ in fits)
    perfect = float(2.0 * np.sum(_worth(lines) * (np.log(power) + 1.0)))
    if not plain - best > CLEARER or best - perfect > FITS * np.count_nonzero(~moving):
        return None
    i = next(i for i, (unlikely, _) in enumerate(fits) if unlikely <= best + AS_GOOD)
    sizes = fits[i][1]
    first, drive = float(sizes[0]), float(sizes[-1])
    seen = float((drive * shapes[i][~moving]).max(initial=0.0))
    return (first, drive, float(CORNERS[i])) if seen > LEAST * first else None


def _likeliest(columns: Floats, power: Floats, lines: Floats) -> tuple[float, Floats]:
    """Twice the negative log-likelihood (Whittle's) of a spectrum, and the sizes (p,) of its parts."""
    from scipy.optimize import nnls

    fitted = power
    for _ in range(REWEIGHTED):
        weight = 1.0 / (np.maximum(fitted, FAINTEST * power) * (UNSURE + np.sqrt(1.0 / lines)))
        weighted = columns * weight[:, None]
        scale = weighted.max(0)
        sizes = nnls(weighted / scale, power * weight, maxiter=STEPS * columns.shape[1])[0] / scale
        fitted = columns @ sizes
    fitted = np.maximum(fitted, FAINTEST * power)
    return float(2.0 * np.sum(_worth(lines) * (np.log(fitted) + power / fitted))), sizes


def _worth(lines: Floats) -> Floats:
    """Lines (b,) that each band is worth, given that shapes are never quite right."""
    return np.asarray(lines / (1.0 + UNSURE**2 * lines))


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
                out[begin:end, k] = whitened(
                    np.ascontiguousarray(errors[begin:end, k]), colour.pole, colour.zero
                )
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
