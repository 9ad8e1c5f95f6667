"""Free curves over motion, time and load, as sums of simple shapes with sizes to be found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    CURVE_KNOTS,
    PERIODIC_CURVE_KNOTS,
    SURFACE_KNOTS,
    TIME_CURVE_KNOTS,
)
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_core.compiled import Floats, Integers
from rthm_core.effects.formula import evaluated
from rthm_core.effects.guess import instants

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

    @property
    def count(self) -> int:
        """How many shapes it has."""
        return max(self.knots.size, 1)

    def shape(self, index: int, variables: Mapping[str, Floats]) -> Floats:
        """Force (s,) along the recording of a curve that is 1 N at one knot and 0 at all others."""
        return hat(variables[self.over], self.knots, index) * evaluated(self.carrier, {}, **variables)


@dataclass(frozen=True)
class Surface:
    """A force over position and velocity, with a jump at rest that differs from place to place.

    Attributes
    ----------
    over_x, over_v : (p,), (q,) arrays
        Knots.
    """

    over_x: Floats
    over_v: Floats

    @property
    def count(self) -> int:
        """How many shapes it has: products first, then jumps."""
        return int(self.over_x.size * (self.over_v.size + 1))

    def shape(self, index: int, variables: Mapping[str, Floats]) -> Floats:
        """Force (s,) along the recording of one of its shapes of size 1, N."""
        x, v = variables["x"], variables["v"]
        products = self.over_x.size * self.over_v.size
        if index >= products:
            return hat(x, self.over_x, index - products) * np.sign(v)
        row, column = divmod(index, self.over_v.size)
        return hat(x, self.over_x, row) * hat(v, self.over_v, column)


def _roughness(count: int) -> Floats:
    """Sum (p, p) of the squared steps from each of some sizes to the next, as a quadratic form."""
    if count < 2:
        return np.zeros((count, count))
    steps = np.diff(np.eye(count), axis=0)
    return np.asarray(steps.T @ steps)


@dataclass(frozen=True, eq=False)
class Feature:
    """A free force. Its shapes are made where they are asked for: along a long recording they are large.

    Attributes
    ----------
    depends_on : tuple of str
        Variables, in the words of the contract.
    variables : mapping
        Arrays (s,) of its variables along the recording.
    parts : tuple of Curve or Surface
        Those of which it is the sum, in the order of their shapes.
    straight : bool
        Whether it is a straight line over time: it says what follows, but any slow change is partly that.
    judges : bool
        Whether kinds are judged by it: not by one that is asked for a formula alone.
    """

    depends_on: tuple[str, ...]
    variables: Mapping[str, Floats]
    parts: tuple[Curve | Surface, ...]
    straight: bool = False
    judges: bool = True

    @property
    def of_mass(self) -> bool:
        """Whether it is over the acceleration, as the force of a mass that changes is."""
        return "a" in self.depends_on

    @property
    def curves(self) -> tuple[Curve, ...]:
        """Its parts; none of a surface."""
        return tuple(one for one in self.parts if isinstance(one, Curve))

    @cached_property
    def _places(self) -> list[tuple[Curve | Surface, int]]:
        """Part of each shape, and its place there."""
        return [(one, index) for one in self.parts for index in range(one.count)]

    @property
    def count(self) -> int:
        """How many shapes it has."""
        return len(self._places)

    def shape(self, index: int, samples: Integers | slice = slice(None)) -> Floats:
        """The force (s,) of a shape of size 1, N, along the recording, or at some of its samples."""
        part, place = self._places[index]
        return part.shape(place, {name: values[samples] for name, values in self.variables.items()})

    def shapes(self, samples: Integers | slice = slice(None)) -> Floats:
        """All of them (s, p)."""
        return np.stack([self.shape(index, samples) for index in range(self.count)], axis=1)

    def force(self, sizes: Floats) -> Floats:
        """Force (s,) along the recording of shapes of some sizes (p,), N."""
        every = (size * self.shape(index) for index, size in enumerate(sizes))
        return np.asarray(sum(every, np.zeros_like(next(iter(self.variables.values())))))

    @property
    def roughness(self) -> Floats:
        """How rough its curves are, as a quadratic form (p, p) of the sizes of its shapes; of a surface, how
        large.
        """
        if not self.curves:
            return np.eye(self.count)
        from scipy.linalg import block_diag

        return np.asarray(block_diag(*(_roughness(one.count) for one in self.curves)))


def features(at: Along) -> Iterator[Feature]:
    """Curves over one variable, surfaces over motion, coefficients that change with time.

    What grows steadily with time is told by straight lines: they alone say what follows. A mass that changes
    with time has no formula: its force is a kind's, or described.
    """
    variables = at._asdict()
    x, v, t, load = at
    with_mass = variables | {"a": at.a}
    over_x, over_v, over_load = (knots(one, CURVE_KNOTS) for one in (x, v, load))
    slow, line = (np.linspace(t[0], t[-1], count) for count in (TIME_CURVE_KNOTS, 2))
    fine, finer = (np.linspace(x.min(), x.max(), n) for n in (2 * CURVE_KNOTS, PERIODIC_CURVE_KNOTS))

    def feature(
        depends_on: str, *parts: Curve | Surface, straight: bool = False, judges: bool = True
    ) -> Feature:
        return Feature(tuple(depends_on.split()), variables, parts, straight, judges)

    yield feature("x", Curve("1", "x", over_x))
    yield feature("x", Curve("1", "x", finer))
    yield feature("v", Curve("1", "v", over_v), Curve("sign(v)", "v", NOTHING))
    yield feature("t", Curve("1", "t", slow))
    yield feature("t", Curve("1", "t", line), straight=True)
    yield feature("x v", Surface(knots(x, SURFACE_KNOTS), knots(v, SURFACE_KNOTS)))
    yield feature("x v", Curve("sign(v)", "x", fine))
    yield feature("x v", Curve("v", "x", over_x), judges=False)
    yield feature("x t", Curve("x", "t", slow))
    yield feature("v t", Curve("v", "t", slow), Curve("sign(v)", "t", slow))
    yield feature("x t", Curve("x", "t", line), straight=True)
    yield feature("v t", Curve("v", "t", line), Curve("sign(v)", "t", line), straight=True)
    for in_time in (instants(t, at.a, TIME_CURVE_KNOTS - 1), line):
        of_mass = Curve("a", "t", in_time)
        yield Feature(("a", "t"), with_mass, (of_mass,), in_time is line, judges=False)
    if np.any(load):
        yield feature("load", Curve("1", "load", over_load))
        yield feature("x load", Curve("x", "load", over_load), judges=False)
        yield feature("t load", Curve("load", "t", slow), judges=False)


def feature_of(at: Along, curve: Curve) -> Feature:
    """One curve by itself."""
    return Feature((curve.over,), at._asdict(), (curve,))


def knots_over(at: Along, variable: str) -> Floats:
    """Knots of a curve over one variable."""
    values = at._asdict()[variable]
    if variable == "t":
        return np.linspace(values[0], values[-1], TIME_CURVE_KNOTS)
    return knots(values, CURVE_KNOTS)


def knots(values: Floats, count: int) -> Floats:
    """Ends and quantiles of some values: (count,) at most, strictly ascending."""
    between = np.quantile(values, np.linspace(0.02, 0.98, count - 2))
    return np.unique([values.min(), *between, values.max()])


def hat(values: Floats, at: Floats, index: int) -> Floats:
    """A shape (s,) that is 1 at one knot, 0 at all others, straight between: polygons are sums of these."""
    if at.size < 2:
        return np.ones(values.size)
    return np.asarray(np.interp(values, at, np.eye(at.size)[index]))
