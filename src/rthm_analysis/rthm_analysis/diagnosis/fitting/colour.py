"""Coloured sensor noise: white noise and a part that forgets with a time constant, and how to whiten it.

A sensor that wanders errs alike in neighbouring samples. Weighed as white noise, such errors look like
physics. Above the frequencies at which the rig moves, the spectrum tells: white noise is flat, noise of a
time constant falls with the square of the frequency, and what a smooth motion leaves falls far faster.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import (
    BAND_POWER_STD,
    COLOUR_LEAST_SHARE_OF_WHITE,
    COLOUR_LIKELIHOOD_GAIN,
    COLOUR_LIKELIHOOD_LOSS,
    COLOUR_MISFIT_PER_BAND,
    COLOUR_RATIO_TO_WHITE,
    COLOUR_SHARE_OF_SIGNAL,
    MOTION_POWER_RATIO,
    SPECTRUM_BANDS,
    SPECTRUM_FEWEST_SAMPLES,
    SPECTRUM_LEAST_POWER,
    SPECTRUM_STEPS,
)
from rthm_analysis.diagnosis.replay.compiled import compiled
from rthm_analysis.diagnosis.signals import filled
from rthm_core.compiled import Flags, Floats, Integers

CORNERS = np.geomspace(3e-4, 1.0, 28)
"""Corner frequencies of the coloured part that are tried, in radians per sample."""


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
    shared : bool
        Whether another channel shows it, too: it is motion then, and no noise.
    """

    pole: float
    zero: float
    innovation: float
    level: float
    shared: bool = False

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
    if residual.size < SPECTRUM_FEWEST_SAMPLES:
        return white(level)
    at, power, lines = _banded(*spectrum(residual))
    if not power.all():
        return white(level)
    moving = moves & (_banded(*spectrum(measured))[1] > MOTION_POWER_RATIO * power)
    found = _parts(at, power, lines, moving)
    if found is None:
        return white(level)
    colour = _innovations(*found)
    colour = replace(colour, level=min(colour.level, float(np.nanstd(residual))))
    coloured = np.sqrt(max(colour.level**2 - found[0], 0.0))
    allowed = max(
        COLOUR_SHARE_OF_SIGNAL * float(np.nanstd(measured)), COLOUR_RATIO_TO_WHITE * np.sqrt(found[0])
    )
    return colour if coloured <= allowed else white(level)


def spectrum(signal: Floats) -> tuple[Floats, Floats]:
    """Frequencies in radians per sample, and power of a signal there: 1 for white noise of power 1.

    A line through all of it is taken out: that is a sensor that drifts, and no noise.
    """
    even, at = filled(signal), np.arange(signal.size)
    taper = np.hanning(signal.size)
    lines = np.fft.rfft((even - np.polyval(np.polyfit(at, even, 1), at)) * taper)[1:]
    return np.pi * np.arange(1, lines.size + 1) / lines.size, np.abs(lines) ** 2 / float(taper @ taper)


def _banded(omega: Floats, power: Floats) -> tuple[Floats, Floats, Floats]:
    """Middle, mean power and number of lines of each band."""
    edges = np.geomspace(omega[0] * 0.99, omega[-1] * 1.001, SPECTRUM_BANDS + 1)
    number = np.searchsorted(edges, omega, side="right") - 1
    count = np.bincount(number, minlength=SPECTRUM_BANDS).astype(float)
    used = count > 0
    mean = np.bincount(number, power, SPECTRUM_BANDS)[used] / count[used]
    return np.bincount(number, omega, SPECTRUM_BANDS)[used] / count[used], mean, 0.5 * count[used]


def _parts(at: Floats, power: Floats, lines: Floats, moving: Flags) -> tuple[float, float, float] | None:
    """White power, drive of the coloured part per sample, and its corner; None: all is white.

    What the model leaves in the bands in which the rig moves may be anything on top of the noise.
    """
    highest = at[moving].max(initial=0.0)
    tail = np.where(at > highest, (at / at[-1]) ** -6.0, 0.0)
    base = np.stack([np.ones_like(at), *([tail] if highest and tail.any() else [])])
    plain, _ = _likeliest(base[None], power, lines, moving)
    shapes = 1.0 / (2.0 - 2.0 * np.cos(at) + CORNERS[:, None] ** 2)
    beside = np.broadcast_to(base, (CORNERS.size, *base.shape))
    unlikely, sizes = _likeliest(np.concatenate([beside, shapes[:, None]], axis=1), power, lines, moving)
    perfect = float(2.0 * np.sum(_worth(lines) * (np.log(power) + 1.0)))
    best = float(unlikely.min())
    clear = plain[0] - best > COLOUR_LIKELIHOOD_GAIN
    if not clear or best - perfect > COLOUR_MISFIT_PER_BAND * np.count_nonzero(~moving):
        return None
    i = int(np.argmax(unlikely <= best + COLOUR_LIKELIHOOD_LOSS))
    first, drive = float(sizes[i, 0]), float(sizes[i, -1])
    seen = float((drive * shapes[i][~moving]).max(initial=0.0))
    return (first, drive, float(CORNERS[i])) if seen > COLOUR_LEAST_SHARE_OF_WHITE * first else None


def _likeliest(parts: Floats, power: Floats, lines: Floats, moving: Flags) -> tuple[Floats, Floats]:
    """Twice the negative log-likelihood (k,) of a spectrum (b,) under each of some models, and their sizes.

    A model is a sum of parts, ``parts`` (k, p, b), in sizes (k, p) that are not negative; in the bands that
    move anything may come on top. Maximised by the multiplicative steps of Itakura-Saito factorisation, none
    of which is for the worse (Févotte and Idier 2011).
    """
    worth = _worth(lines)
    floor = np.where(moving, power, SPECTRUM_LEAST_POWER * power)
    sizes = np.median(power) / parts.max(axis=2) / parts.shape[1]
    for _ in range(SPECTRUM_STEPS):
        fitted = np.maximum(np.einsum("kp,kpb->kb", sizes, parts), floor)
        up = np.einsum("kpb,kb->kp", parts, worth * power / fitted**2)
        sizes = sizes * np.sqrt(up / np.einsum("kpb,kb->kp", parts, worth / fitted))
    fitted = np.maximum(np.einsum("kp,kpb->kb", sizes, parts), floor)
    return 2.0 * np.sum(worth * (np.log(fitted) + power / fitted), axis=1), sizes


def _worth(lines: Floats) -> Floats:
    """Lines (b,) that each band is worth, given that shapes are never quite right."""
    return np.asarray(lines / (1.0 + BAND_POWER_STD**2 * lines))


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
                _whiten(out[begin:end, k], colour.pole, colour.zero)
    return out


@compiled
def _whiten(signal: Floats, pole: float, zero: float) -> None:
    """Put the innovations of a signal (s,), 0 before its first sample, in its place."""
    before, error = 0.0, 0.0
    for t in range(signal.size):
        value = signal[t]
        error = value - pole * before + zero * error
        before = value
        signal[t] = error
