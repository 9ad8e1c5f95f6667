"""The grammar of formulas: shapes over one variable, with the numbers from which a fit of each may begin."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    BEYOND_SHARES,
    BUMP_PLACES,
    PITCH_COUNT,
    SHAPE_POWERS,
    SHAPE_SCALES,
    SWINGING_ANGLES,
    THRESHOLD_COUNT,
)
from rthm_core.compiled import Floats


class Shape(NamedTuple):
    """A shape over one variable.

    Attributes
    ----------
    text : str
        Formula of ``w`` and of the numbers ``p`` and ``q``.
    numbers : tuple of float
        Where a fit of p and q may begin.
    steps : tuple of float
        How far they may be off there.
    """

    text: str
    numbers: tuple[float, ...] = ()
    steps: tuple[float, ...] = ()


BEYOND, WITHIN = "(p < w)", "(p < w) * (w < q)"
WAVE = "sin(2 * pi * w / p + q)"
POLES = ("1 / (w - p)", "1 / (w - p) + 1 / p", "1 / (w - p)**2", "1 / (w - p)**2 - 1 / p**2")
EVEN = ("w**2", "abs(w)")
PENDULUM = "w - sin(w)"
ODD = ("w", "w**3", "w * abs(w)", "w**5")


def shapes_over(variable: str, at: Floats) -> Iterator[Shape]:
    """Shapes that a curve with these knots, over x, v, t, load, u or elongation, can show."""
    yield Shape("1")
    if at.size < 2:
        return
    yield from _thresholds(at)
    if variable == "t":
        yield Shape("w")
        yield from (Shape("exp(-w / p)", (one,), (0.3 * one,)) for one in _scales(at))
        return
    yield from map(Shape, (*ODD, *EVEN))
    if variable == "x" and SWINGING_ANGLES[0] < np.abs(at).max() < SWINGING_ANGLES[1]:
        yield Shape(PENDULUM)
    yield from (Shape("sign(w) * abs(w)**p", (power,), (0.2,)) for power in SHAPE_POWERS)
    for one in _scales(at):
        yield Shape("tanh(w / p)", (one,), (0.3 * one,))
        yield Shape("sign(w) * exp(-abs(w) / p)", (one,), (0.3 * one,))
        yield Shape("w - p * sin(w / p)", (one,), (0.3 * one,))
        yield Shape("sign(w) * max(abs(w) - p, 0)", (one,), (0.3 * one,))
        yield from (Shape("exp(w / p) - 1", (side * one,), (0.3 * one,)) for side in (1.0, -1.0))
    yield from _bumps(at)
    if variable in ("x", "u"):
        yield from _poles(at)
        apart = np.diff(at)  # knots of a free curve are as far apart as the motion is rare, bins are even
        yield from _waves(at, float(apart.max() if variable == "x" else np.median(apart)))


def _scales(at: Floats) -> list[float]:
    largest = float(np.abs(at).max())
    return [share * largest for share in SHAPE_SCALES]


def _inner(at: Floats) -> list[float]:
    """Places within the range at which something may begin or end."""
    evenly = np.linspace(0.0, 1.0, THRESHOLD_COUNT + 2)[1:-1]
    return [float(one) for one in np.interp(evenly, np.linspace(0.0, 1.0, at.size), at)]


def _thresholds(at: Floats) -> Iterator[Shape]:
    """Beyond a place, before it, between two; straight from a place on."""
    places = _inner(at)
    step = 0.5 * float(np.median(np.diff(places)))
    for one in places:
        yield Shape(BEYOND, (one,), (step,))
        yield Shape("max(w - p, 0)", (one,), (step,))
        yield Shape("max(p - w, 0)", (one,), (step,))
    for low, high in combinations(places, 2):
        yield Shape(WITHIN, (low, high), (step, step))


def _bumps(at: Floats) -> Iterator[Shape]:
    """Bells, and what pulls to a place or away from it."""
    for place in np.linspace(at[0], at[-1], BUMP_PLACES).tolist():
        for width in _scales(at)[1:4]:
            numbers, steps = (place, width), (0.3 * width, 0.3 * width)
            yield Shape("exp(-((w - p) / q)**2)", numbers, steps)
            yield Shape("(w - p) * exp(-((w - p) / q)**2)", numbers, steps)


def _poles(at: Floats) -> Iterator[Shape]:
    """What grows beyond all bounds out of the range, as the pull of a magnet; as it is, or zero at rest."""
    low, high = float(at[0]), float(at[-1])
    for share in BEYOND_SHARES:
        beyond = share * (high - low)
        for pole in (high + beyond, low - beyond):
            for text in POLES:
                yield Shape(text, (pole,), (0.3 * beyond,))


def _waves(at: Floats, finest: float) -> Iterator[Shape]:
    """What comes back again and again, in any phase, as long as three places are seen of each period."""
    span = float(at[-1] - at[0])
    for pitch in np.geomspace(max(3.0 * finest, span / 25.0), 2.0 * span, PITCH_COUNT):
        for phase in np.linspace(-np.pi, np.pi, 8, endpoint=False):
            yield Shape(WAVE, (float(pitch), float(phase)), (0.03 * pitch, 0.4))
