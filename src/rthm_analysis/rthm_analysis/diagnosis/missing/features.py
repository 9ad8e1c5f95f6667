"""Free curves over motion, time and load, as sums of simple shapes with sizes to be found."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    CURVE_KNOTS,
    PERIODIC_CURVE_KNOTS,
    SURFACE_KNOTS,
    TIME_CURVE_KNOTS,
)
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Feature:
    """A free curve.

    Attributes
    ----------
    depends_on : tuple of str
        Variables, in the words of the contract.
    shapes : (s, p) array
        The force of each shape of size 1, N, along the recording.
    straight : bool
        Whether it is a straight line over time: it says what follows, but any slow change is partly that.
    """

    depends_on: tuple[str, ...]
    shapes: Floats
    straight: bool = False


def features(at: Along, time: Floats, load: Floats) -> Iterator[Feature]:
    """Curves over one variable, surfaces over motion, coefficients that change with time.

    What grows steadily with time is told by straight lines: they alone say what follows.
    """
    x, v = hats(at.x, knots(at.x, CURVE_KNOTS)), hats(at.v, knots(at.v, CURVE_KNOTS))
    slow = hats(time, np.linspace(time[0], time[-1], TIME_CURVE_KNOTS))
    sign = np.sign(at.v)[:, None]
    line = np.column_stack([np.ones_like(time), (time - time[0]) / (time[-1] - time[0])])
    yield Feature(("x",), x)
    yield Feature(("x",), hats(at.x, np.linspace(at.x.min(), at.x.max(), PERIODIC_CURVE_KNOTS)))
    yield Feature(("v",), np.hstack([v, sign]))
    yield Feature(("t",), slow)
    yield Feature(("t",), line, straight=True)
    coarse = hats(at.x, knots(at.x, SURFACE_KNOTS)), hats(at.v, knots(at.v, SURFACE_KNOTS))
    yield Feature(("x", "v"), np.hstack([_products(*coarse), coarse[0] * sign]))
    yield Feature(("x", "v"), hats(at.x, np.linspace(at.x.min(), at.x.max(), 2 * CURVE_KNOTS)) * sign)
    yield Feature(("x", "t"), slow * at.x[:, None])
    yield Feature(("v", "t"), np.hstack([slow * at.v[:, None], slow * sign]))
    yield Feature(("x", "t"), line * at.x[:, None], straight=True)
    yield Feature(("v", "t"), np.hstack([line * at.v[:, None], line * sign]), straight=True)
    if np.any(load):
        yield Feature(("load",), hats(load, knots(load, CURVE_KNOTS)))


def knots(values: Floats, count: int) -> Floats:
    """Ends and quantiles of some values: (count,) at most, strictly ascending."""
    between = np.quantile(values, np.linspace(0.02, 0.98, count - 2))
    return np.unique([values.min(), *between, values.max()])


def hats(values: Floats, at: Floats) -> Floats:
    """Shapes (s, p) that are 1 at one knot, 0 at all others, straight between: any polygon is their sum."""
    if at.size < 2:
        return np.ones((values.size, 1))
    return np.stack([np.interp(values, at, row) for row in np.eye(at.size)], axis=1)


def _products(first: Floats, second: Floats) -> Floats:
    return (first[:, :, None] * second[:, None, :]).reshape(first.shape[0], -1)
