"""Free curves over motion, time and load, as sums of simple shapes with sizes to be found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
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
from rthm_core.effects.formula import evaluated

NOTHING = np.empty(0)


@dataclass(frozen=True)
class Curve:
    """A free curve over one variable, times something that is known.

    Attributes
    ----------
    carrier : str
        What it is multiplied with, as a formula of the variables.
    over : str
        Its variable, in the words of the contract.
    knots : (p,) array
        Where it is free, ascending; none: it is a number.
    """

    carrier: str
    over: str
    knots: Floats

    def shapes(self, variables: Mapping[str, Floats]) -> Floats:
        """Force (s, p) along the recording of a curve that is 1 N at one knot and 0 at all others."""
        return hats(variables[self.over], self.knots) * evaluated(self.carrier, {}, **variables)[:, None]


def _roughness(count: int) -> Floats:
    """Sum (p, p) of the squared steps from each of some sizes to the next, as a quadratic form."""
    if count < 2:
        return np.zeros((count, count))
    steps = np.diff(np.eye(count), axis=0)
    return np.asarray(steps.T @ steps)


@dataclass(frozen=True, eq=False)
class Feature:
    """A free force.

    Attributes
    ----------
    depends_on : tuple of str
        Variables, in the words of the contract.
    shapes : (s, p) array
        The force of each shape of size 1, N, along the recording.
    straight : bool
        Whether it is a straight line over time: it says what follows, but any slow change is partly that.
    curves : tuple of Curve
        Those of which it is the sum, in the order of their shapes; none for a surface.
    judges : bool
        Whether kinds are judged by it: not by one that is asked for a formula alone.
    """

    depends_on: tuple[str, ...]
    shapes: Floats
    straight: bool = False
    curves: tuple[Curve, ...] = ()
    judges: bool = True

    @property
    def of_mass(self) -> bool:
        """Whether it is over the acceleration, as the force of a mass that changes is."""
        return "a" in self.depends_on

    @property
    def roughness(self) -> Floats:
        """How rough its curves are, as a quadratic form (p, p) of the sizes of its shapes; of a surface, how
        large.
        """
        if not self.curves:
            return np.eye(self.shapes.shape[1])
        from scipy.linalg import block_diag

        return np.asarray(block_diag(*(_roughness(max(one.knots.size, 1)) for one in self.curves)))


def features(at: Along) -> Iterator[Feature]:
    """Curves over one variable, surfaces over motion, coefficients that change with time.

    What grows steadily with time is told by straight lines: they alone say what follows. A mass that changes
    with time has no formula: its force is a kind's, or described.
    """
    variables = at._asdict()
    x, v, t, load = at
    over_x, over_v, over_load = (knots(one, CURVE_KNOTS) for one in (x, v, load))
    slow, line = (np.linspace(t[0], t[-1], count) for count in (TIME_CURVE_KNOTS, 2))
    fine, finer = (np.linspace(x.min(), x.max(), n) for n in (2 * CURVE_KNOTS, PERIODIC_CURVE_KNOTS))

    def feature(depends_on: str, *curves: Curve, straight: bool = False, judges: bool = True) -> Feature:
        shapes = np.hstack([one.shapes(variables) for one in curves])
        return Feature(tuple(depends_on.split()), shapes, straight, curves, judges)

    yield feature("x", Curve("1", "x", over_x))
    yield feature("x", Curve("1", "x", finer))
    yield feature("v", Curve("1", "v", over_v), Curve("sign(v)", "v", NOTHING))
    yield feature("t", Curve("1", "t", slow))
    yield feature("t", Curve("1", "t", line), straight=True)
    yield _surface(x, v)
    yield feature("x v", Curve("sign(v)", "x", fine))
    yield feature("x v", Curve("v", "x", over_x), judges=False)
    yield feature("x t", Curve("x", "t", slow))
    yield feature("v t", Curve("v", "t", slow), Curve("sign(v)", "t", slow))
    yield feature("x t", Curve("x", "t", line), straight=True)
    yield feature("v t", Curve("v", "t", line), Curve("sign(v)", "t", line), straight=True)
    acceleration = at.a[:, None]
    for knots_in_time in (slow, line):
        of_mass = Curve("a", "t", knots_in_time)
        shapes = acceleration * hats(t, knots_in_time)
        yield Feature(("a", "t"), shapes, knots_in_time is line, (of_mass,), judges=False)
    if np.any(load):
        yield feature("load", Curve("1", "load", over_load))
        yield feature("x load", Curve("x", "load", over_load), judges=False)
        yield feature("t load", Curve("load", "t", slow), judges=False)


def feature_of(at: Along, curve: Curve) -> Feature:
    """One curve by itself."""
    return Feature((curve.over,), curve.shapes(at._asdict()), curves=(curve,))


def knots_over(at: Along, variable: str) -> Floats:
    """Knots of a curve over one variable."""
    values = at._asdict()[variable]
    if variable == "t":
        return np.linspace(values[0], values[-1], TIME_CURVE_KNOTS)
    return knots(values, CURVE_KNOTS)


def _surface(x: Floats, v: Floats) -> Feature:
    """A force over position and velocity, with a jump at rest that differs from place to place."""
    over_x, over_v = hats(x, knots(x, SURFACE_KNOTS)), hats(v, knots(v, SURFACE_KNOTS))
    return Feature(("x", "v"), np.hstack([_products(over_x, over_v), over_x * np.sign(v)[:, None]]))


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
