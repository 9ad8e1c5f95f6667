"""What a source says of a test: named signals over the time since its start."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.recording import hold
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec

GAP_OF_SAMPLES = 10
"""Distance of two samples, over their usual one, from which nothing is known of what is between them."""


@dataclass(frozen=True)
class Signal:
    """One signal of a test.

    Attributes
    ----------
    name : str
        ``x1`` (position of a dof), ``a1.motor``, ``a1.command``, ``a1.force``, ``a1.reference`` (of an
        actuator: position and command of its motor, force in its wire, force reference in use), ``E_num``.
    unit : str
        m, N or J.
    at_ns : (n,) array
        Ascending instants since the start of the test, ns; n may be 0.
    values : (n,) array
        All of them known.
    held : bool
        Whether a value stays until the next one: a step, never a straight line.
    """

    name: str
    unit: str
    at_ns: Integers
    values: Floats
    held: bool = False

    @property
    def usual_ns(self) -> int:
        """Usual distance of the samples, ns."""
        return int(np.median(np.diff(self.at_ns))) if self.at_ns.size > 1 else 0

    @property
    def begin_ns(self) -> int:
        """First instant at which it is known."""
        return int(self.at_ns[0])

    @property
    def end_ns(self) -> int:
        """Last instant at which it is known; a held value is known for as long as values usually stay."""
        return int(self.at_ns[-1]) + (self.usual_ns if self.held else 0)

    def at(self, instants_ns: Integers) -> Floats:
        """Values at instants (m,); NaN before the first sample, after the last, and within gaps.

        Examples
        --------
        >>> ramp = Signal("x1", "m", np.array([0, 10, 20]), np.array([0.0, 1.0, 2.0]))
        >>> ramp.at(np.array([-5, 5, 20, 25])).tolist()
        [nan, 0.5, 2.0, nan]
        """
        known = (instants_ns >= self.begin_ns) & (instants_ns <= self.end_ns)
        if self.held:
            return np.where(known, hold(self.at_ns, self.values, instants_ns), np.nan)
        after = np.minimum(np.searchsorted(self.at_ns, instants_ns), self.at_ns.size - 1)
        wide = self.at_ns[after] - self.at_ns[np.maximum(after - 1, 0)] > GAP_OF_SAMPLES * self.usual_ns
        known &= ~wide | (self.at_ns[after] == instants_ns)
        return np.where(known, np.interp(instants_ns, self.at_ns, self.values), np.nan)


class Pair(NamedTuple):
    """Two signals at the same instants, (n,) arrays: s since the start of the test, and their values."""

    time: Floats
    one: Floats
    other: Floats


def paired(one: Signal, other: Signal) -> Pair:
    """Two signals at the instants at which both are known, those of the one that has fewer of them.

    A held signal is read at the instants of one that is sampled.
    """
    if not one.at_ns.size or not other.at_ns.size:
        return Pair(*(np.empty(0),) * 3)
    instants = _instants(one, other)
    a, b = one.at(instants), other.at(instants)
    known = np.isfinite(a) & np.isfinite(b)
    return Pair(instants[known] / NS, a[known], b[known])


def _instants(one: Signal, other: Signal) -> Integers:
    begin, end = max(one.begin_ns, other.begin_ns), min(one.end_ns, other.end_ns)
    within = [at[(at >= begin) & (at <= end)] for at in (one.at_ns, other.at_ns)]
    if one.held != other.held:
        return within[one.held]
    return min(within, key=len)


@dataclass(frozen=True)
class Motion:
    """What a source says of a test.

    Attributes
    ----------
    name : str
        As the source was called.
    kind : str
        ``recording``, ``trajectory`` (of a file) or ``simulation`` (of a spec).
    signals : dict of Signal
        By name.
    dofs : tuple of str
        Which of the signals are positions of dofs, those of the plant first.
    actuators : tuple of str
    spec : Spec, optional
        What the test was to be.
    recording : Recording, optional
        What else was recorded.
    passed : Signal, optional
        Integral of the squared velocity of the plant at the interface, m^2/s.
    notes : tuple of str
        What could not be read, and why.
    """

    name: str
    kind: str
    signals: dict[str, Signal]
    dofs: tuple[str, ...]
    actuators: tuple[str, ...]
    spec: Spec | None = None
    recording: Recording | None = None
    passed: Signal | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def duration(self) -> float:
        """Seconds from the start of the test to the last sample of the first dof."""
        return self.signals[self.dofs[0]].end_ns / NS

    @property
    def words(self) -> str:
        """Name, kind and length."""
        return f"{self.name} ({self.kind}, {self.duration:.4g} s)"


def signal(name: str, unit: str, at_ns: Integers, values: Floats, *, held: bool = False) -> dict[str, Signal]:
    """Signal by its name, from what is known of it; nothing where nothing is."""
    known = np.isfinite(values)
    return {name: Signal(name, unit, at_ns[known], values[known], held)} if known.any() else {}
