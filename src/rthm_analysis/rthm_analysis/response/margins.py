"""Gain, phase and delay margin of a loop that is cut at the command of one motor (``docs/theory.md``).

Once round the loop a command u comes back as L u, with the loop transfer L(s) of `LoopTransfer`. The motion
keeps itself up where L = 1. Source of the definitions: Åström and Murray, Feedback Systems, chapter on
frequency domain analysis; their loop transfer is -L, as their loop has a minus sign.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rthm_analysis.lifted.matrices import LinearLoop
from rthm_analysis.response.models import Complex, Paths, once_round
from rthm_core.compiled import Floats

TURN = 0.3
"""Radians by which L or 1 - L may turn from one frequency of the search to the next."""

ROUNDS, MOST = 24, 40_000
"""How often intervals are halved for that, and how many frequencies there may be."""

DECADES, FIRST = 3.0, 1500
"""Decades of the search below the slowest and above the fastest pole, and its first frequencies."""

LEAST = 1e-3
"""|L| below which its phase does not matter: no gain of a thousand is looked for."""

NONE = "-"
"""Stands for a margin that there is not."""


class Edge(NamedTuple):
    """A margin, and the frequency (rad/s) of the motion that then keeps itself up."""

    value: float
    omega: float

    def as_dict(self) -> dict[str, float]:
        """Entry of the JSON."""
        return self._asdict()


@dataclass(frozen=True)
class Margins:
    """How far the loop, cut at the command of one motor, is from L = 1; the others stay closed.

    Attributes
    ----------
    actuator : str
        Whose command it is.
    gain, gain_below : Edge or None
        Least factor above 1, and largest below it, on the command at which stability is lost; None: no such.
    phase : Edge or None
        Smallest turn of the command at which it is lost, rad; + is lag.
    delay : Edge or None
        Shortest further delay of the command at which it is lost, s.
    """

    actuator: str
    gain: Edge | None = None
    gain_below: Edge | None = None
    phase: Edge | None = None
    delay: Edge | None = None

    @property
    def words(self) -> tuple[str, str, str]:
        """Gain, phase and delay margin, each with the frequency of the motion at the edge."""
        gain = " and ".join(f"{one.value:.3g} x {_at(one)}" for one in (self.gain_below, self.gain) if one)
        phase = self.phase and f"{math.degrees(self.phase.value):+.3g} deg {_at(self.phase)}"
        delay = self.delay and f"{1e3 * self.delay.value:.4g} ms {_at(self.delay)}"
        return gain or NONE, phase or NONE, delay or NONE

    def as_dict(self) -> dict[str, object]:
        """Entry of ``margins`` in the JSON of ``rthm response``."""
        phase = self.phase and Edge(math.degrees(self.phase.value), self.phase.omega)
        told = {"gain": self.gain, "gain_below": self.gain_below, "phase_deg": phase, "delay": self.delay}
        return {"actuator": self.actuator} | {name: one and one.as_dict() for name, one in told.items()}


def _at(edge: Edge) -> str:
    return f"at {edge.omega:.4g} rad/s"


class LoopTransfer:
    """L(i omega) for each motor: what becomes of its command once round the loop, the others closed.

    With R the matrix of `once_round`, ``1 - L_i = det(I - R) / det(I - R without row and column i)``.
    """

    def __init__(self, loop: LinearLoop, ways: Paths) -> None:
        self.loop, self.ways = loop, ways

    def __call__(self, omega: Floats) -> Complex:
        """Loop transfers (W, m)."""
        apart, m = self._apart(omega), self.loop.actuators
        whole = np.linalg.det(apart)
        minors = [np.delete(np.delete(apart, k, axis=1), k, axis=2) for k in range(m)]
        return np.stack([1.0 - whole / np.linalg.det(minor) for minor in minors], axis=1)

    def whole(self, omega: Floats) -> Complex:
        """det(I - R), (W,), whose zeros are the poles of the closed loop."""
        return np.asarray(np.linalg.det(self._apart(omega)))

    def _apart(self, omega: Floats) -> Complex:
        r = np.stack([once_round(self.loop, self.ways, 1j * w) for w in np.atleast_1d(omega)])
        return np.asarray(np.eye(self.loop.actuators) - r)


def margins_of(transfer: LoopTransfer, names: tuple[str, ...]) -> tuple[Margins, ...]:
    """Margins at the command of every motor; nothing but names where the loop is not stable."""
    if not is_stable(transfer):
        return tuple(Margins(name) for name in names)
    return tuple(_margins(name, _column(transfer, k), transfer) for k, name in enumerate(names))


def is_stable(transfer: LoopTransfer) -> bool:
    """Nyquist's criterion: as often as det(I - R) turns round zero, so many open poles are not stable."""
    omega = _frequencies(transfer, lambda omega: 1.0 - transfer.whole(omega))
    turned = float(np.sum(_turns(transfer.whole(omega)))) / math.pi
    poles = np.concatenate([np.linalg.eigvals(transfer.loop.a1), np.linalg.eigvals(transfer.loop.a2)])
    return round(np.count_nonzero(poles.real > 0.0) - turned) == 0


def _margins(name: str, one: Callable[[Floats], Complex], transfer: LoopTransfer) -> Margins:
    omega = _frequencies(transfer, one)
    factors, turns = _factors(one, omega), _lags(one, omega)
    above, below = [f for f in factors if f.value > 1.0], [f for f in factors if f.value < 1.0]
    whole_turns = [Edge(lag % math.tau / w, w) for lag, w in turns]
    return Margins(
        name,
        min(above, default=None),
        max(below, default=None),
        min(turns, key=lambda edge: abs(edge.value), default=None),
        min(whole_turns, default=None),
    )


def _lags(one: Callable[[Floats], Complex], omega: Floats) -> list[Edge]:
    """Phase of L, rad in (-pi, pi], wherever its amplitude is 1: the lag that makes it 1."""
    values = np.log(np.abs(one(omega)))
    places = _roots(lambda w: float(np.log(np.abs(one(np.array([w]))))[0]), omega, values)
    return [Edge(float(np.angle(one(np.array([w])))[0]), w) for w in places]


def _factors(one: Callable[[Floats], Complex], omega: Floats) -> list[Edge]:
    """1 / L wherever it is real and positive, at rest included: the factor that makes it 1."""
    values = one(omega)
    places = _roots(lambda w: float(one(np.array([w])).imag[0]), omega, values.imag)
    found = [Edge(1.0 / float(one(np.array([w])).real[0]), w) for w in places]
    (rest,) = one(1e-3 * omega[:1])
    if abs(rest.imag) < 1e-3 * abs(rest):
        found.append(Edge(1.0 / float(rest.real), 0.0))
    return [edge for edge in found if 0.0 < edge.value < 1.0 / LEAST]


def _roots(function: Callable[[float], float], omega: Floats, values: Floats) -> list[float]:
    from scipy.optimize import brentq

    signs = np.sign(values)
    return [
        float(brentq(function, low, high, xtol=1e-12, rtol=1e-12))
        for (low, high), (one, other) in zip(pairwise(omega), pairwise(signs), strict=True)
        if one * other < 0.0
    ]


def _frequencies(transfer: LoopTransfer, one: Callable[[Floats], Complex]) -> Floats:
    """Frequencies so close that neither `one` nor its distance from 1 turns far between two of them."""
    poles = np.concatenate([np.linalg.eigvals(transfer.loop.a1), np.linalg.eigvals(transfer.loop.a2)])
    size = np.abs(poles[np.abs(poles) > 0.0])
    slow, fast = np.log10(size.min()) - DECADES, np.log10(size.max()) + DECADES
    omega = np.logspace(slow, fast, FIRST)
    values = one(omega)
    for _ in range(ROUNDS):
        far = (np.abs(_turns(values)) > TURN) & (np.abs(values[1:]) > LEAST)
        far |= np.abs(_turns(1.0 - values)) > TURN
        if not far.any() or omega.size > MOST:
            break
        between = np.sqrt(omega[1:] * omega[:-1])[far]
        omega, values = np.append(omega, between), np.append(values, one(between))
        order = np.argsort(omega)
        omega, values = omega[order], values[order]
    return omega


def _turns(values: Complex) -> Floats:
    """By how much each value is turned from the one before it, rad."""
    return np.asarray(np.angle(values[1:] * np.conj(values[:-1])))


def _column(transfer: LoopTransfer, k: int) -> Callable[[Floats], Complex]:
    return lambda omega: transfer(omega)[:, k]
