"""Where a fit of a law begins: what the law itself says, from how large things are in a recording."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol


class Signals(Protocol):
    """Motion and forces at the place of a law, as a recording shows them.

    Attributes
    ----------
    x, v, a : (s,) arrays
        Motion of the dof: m, m/s, m/s^2.
    force : (s,) array
        What drives it, N.
    elongation : (s,) array
        Of the wire, m; empty at a dof.
    time : (s,) array
        s.
    mass, stiffness : float
        Of the dof, kg, and of the wire, N/m.
    frequency : float
        Where most of the motion is, rad/s.
    size : float
        Scale of the forces, N.
    """

    x: Any
    v: Any
    a: Any
    force: Any
    elongation: Any
    time: Any
    mass: float
    stiffness: float

    @property
    def frequency(self) -> float:
        """Where most of the motion is, rad/s."""

    @property
    def size(self) -> float:
        """Scale of the forces, N."""


@dataclass(frozen=True)
class Guess:
    """Parameters from which a fit of a law may begin.

    Attributes
    ----------
    values : dict of float
        All parameters; a small force (some hundredths of ``Signals.size``) is best.
    linear : tuple of str
        Parameters in which, together, the force is linear: their size is then found from one replay, and
        whatever is given here is only a trial. Empty: the values are tried as they are.
    signed : bool
        Whether that size may be negative.
    """

    values: dict[str, float]
    linear: tuple[str, ...] = ()
    signed: bool = False
