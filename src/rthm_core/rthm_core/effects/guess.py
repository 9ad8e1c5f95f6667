"""Where a fit of an effect begins: what its kind says, from how large things are in a recording."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

INSTANTS = 12
"""Parts into which the instants divide a recording at which a fit of what begins may begin."""

TRIAL_FORCE = 0.02
"""Force of an effect in its trial replay, as a part of the force that drives the dof."""


class Signals(Protocol):
    """Motion and forces at the place of a law of plant or wire, as a recording shows them.

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

    def ringing(self, lowest: float) -> Iterable[float]:
        """Frequencies above `lowest`, rad/s, of what a linear wire leaves of its recorded force."""


class MotorSignals(Protocol):
    """What a motor does, as its recorded position and its commands show it.

    Attributes
    ----------
    position, speed : (s,), (s - 1,) arrays
        Recorded position, m, and size of its rate between samples, m/s.
    """

    position: Any
    speed: Any

    def delay(self) -> tuple[float, float]:
        """Delay beside the spec's that fits best, and how far it may be from it without a difference, s;
        zero where none helps.
        """

    def step(self) -> float | None:
        """Step to which commands are rounded, m; None where none shows."""


class SensorSignals(Protocol):
    """How large the reading of a sensor is.

    Attributes
    ----------
    noise, spread : float
        Standard deviations of its noise and of the reading itself, in the unit of the signal.
    rate : float
        Root mean square of the reading's rate, unit per s.
    duration : float
        s.
    """

    noise: float
    spread: float
    rate: float
    duration: float


@dataclass(frozen=True)
class Guess:
    """Parameters from which a fit of an effect may begin.

    Attributes
    ----------
    values : dict of float
        All parameters; a small force (some hundredths of ``Signals.size``) is best.
    linear : tuple of str
        Parameters in which, together, the force is linear: their size is then found from one replay, and
        whatever is given here is only a trial. Empty: the values are tried as they are.
    signed : bool
        Whether that size may be negative.
    apart : bool
        Whether the force is linear in the second of them by itself, too.
    neutral : float
        Value of the first of them at which the effect does nothing.
    fixed : tuple of str
        Parameters that the fit leaves as they are.
    scales : mapping of float
        Typical sizes of parameters for which the values themselves are none.
    """

    values: dict[str, float]
    linear: tuple[str, ...] = ()
    signed: bool = False
    apart: bool = False
    neutral: float = 0.0
    fixed: tuple[str, ...] = ()
    scales: Mapping[str, float] = field(default_factory=dict)


def rms(signal: Any) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(signal)))) if signal.size else 0.0


def instants(time: Any, a: Any, parts: int = INSTANTS) -> Any:
    """Instants (parts + 1,) that divide a recording into parts of equal weight: half of it is time, half the
    squared acceleration. Where the motion dies away they follow it, and some are in the rest all the same.

    Parameters
    ----------
    time, a : (s,) arrays
        s and m/s^2.
    parts : int
    """
    power = np.cumsum(np.square(a))
    share = (time - time[0]) / (time[-1] - time[0]) + power / (power[-1] or 1.0)
    return np.interp(np.linspace(share[0], share[-1], parts + 1), share, time)
