"""What is physically possible beyond the bounds of a spec, as the kinds of effects declare it.

A spec may ask for a spring that pulls things apart, so that it can be simulated. A fit that ends at one has
found that the kind is another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

UNSURE = 0.5
"""Part of its value from which the standard deviation of a parameter leaves even its size open: zero is then
within two of them."""

SURE = 0.05
"""The same of a parameter without which a kind says nothing: where a contact is, how large a tone is. An edge
that is placed no better is a smooth law, and a tone that is known no better what another model left."""

AWAY = 0.02
"""Part of the range of motion by which a contact lies away from rest and from both ends of the range: nearer
by, it is a spring that always acts, or one that is never touched."""


@dataclass(frozen=True)
class Seen:
    """What a recording shows of the place where an effect acts; nothing in particular where it is not said.

    Attributes
    ----------
    step, duration : float
        Between two samples, and of all of them, s.
    mass : float
        Of the dof, kg.
    lowest, highest : float
        Positions that were reached, m.
    speed : float
        Highest that was reached, m/s.
    """

    step: float = 0.0
    duration: float = math.inf
    mass: float = math.inf
    lowest: float = -math.inf
    highest: float = math.inf
    speed: float = math.inf

    @property
    def frequencies(self) -> tuple[float, float]:
        """Those of which there is one period at least and four samples in each, rad/s."""
        return 2.0 * math.pi / self.duration, 0.5 * math.pi / self.step if self.step else math.inf

    @property
    def times(self) -> tuple[float, float]:
        """Time constants that are neither at once nor never, s."""
        return self.step, self.duration

    @property
    def margin(self) -> float:
        """Distance of a contact from rest and from the ends of the motion, m."""
        reached = self.highest - self.lowest
        return AWAY * reached if math.isfinite(reached) else 0.0


ANYTHING = Seen()
"""Of a recording of which nothing is known."""

Values = Mapping[str, float]
Possible = Callable[[Values, Seen], tuple[float, float]]
"""Lowest and highest value of a parameter, given the others and what a recording shows."""


def between(low: float, high: float = math.inf) -> Possible:
    """Bounds that depend on nothing."""
    return lambda p, seen: (low, high)


def in_band(p: Values, seen: Seen) -> tuple[float, float]:
    """Frequencies that a recording can show."""
    return seen.frequencies


def less_than_the_dof(p: Values, seen: Seen) -> tuple[float, float]:
    """A mass that is part of the one it hangs on."""
    return 0.0, seen.mass


def relaxing(p: Values, seen: Seen) -> tuple[float, float]:
    """Damping of a branch with its spring's stiffness: it relaxes neither at once nor never."""
    fastest, slowest = seen.times
    return p["stiffness"] * fastest, p["stiffness"] * slowest if p["stiffness"] else math.inf


@dataclass(frozen=True)
class Plainer:
    """A plainer kind of the same block that another may stand for: it is named where it does as well.

    Attributes
    ----------
    kind : str
    values : callable
        Its parameters from those of the other.
    grows : tuple of str
        Parameters of the other that all grow by the same where the plainer kind grows: it is then a special
        case of the other. Empty where it is only a limit of it.
    beyond : callable or None
        Where a fit of the other may begin, from the fitted values of the plainer kind and those of its own
        first guess.
    """

    kind: str
    values: Callable[[Values], dict[str, float]]
    grows: tuple[str, ...] = ()
    beyond: Callable[[Values, Values], Iterable[dict[str, float]]] | None = None


@dataclass(frozen=True)
class Twin:
    """Another kind of the same block whose force is nearly the same: one is tried where the other is found.

    Attributes
    ----------
    kind : str
    values : callable
        Parameters with which it is most like this one, from those of this one.
    """

    kind: str
    values: Callable[[Values], dict[str, float]]


def identified(values: Values, stds: Values, within: Values = MappingProxyType({})) -> bool:
    """Whether the standard deviations leave every value its size, or what is asked `within` it."""
    return all(std <= within.get(name, UNSURE) * abs(values[name]) for name, std in stds.items())
