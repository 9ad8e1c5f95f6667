"""The two-mass loop in 50-digit arithmetic, with an event sequence of its own.

Shares nothing with the engine: matrices, order of events and exponentials are written here once more.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mp, mpf

from rthm_core.compiled import Floats
from rthm_core.spec import Spec

DIGITS = 50


class _Mass:
    """Mass between springs: exact steps about its rest position."""

    def __init__(self, mass: Any, damping: Any, stiffness: Any, x: Any, v: Any) -> None:
        self.decay = damping / (2 * mass)
        self.square = stiffness / mass
        self.x, self.v, self.rest, self.time = x, v, mpf(0), 0
        self._steps: dict[int, tuple[Any, ...]] = {}

    def _step(self, length: int) -> tuple[Any, ...]:
        if length not in self._steps:
            t, w = mpf(length) / 10**9, mp.sqrt(self.square - self.decay**2)
            e, c, s = mp.exp(-self.decay * t), mp.cos(w * t), mp.sin(w * t) / w
            matrix = (c + self.decay * s, s, -self.square * s, c - self.decay * s)
            self._steps[length] = tuple(e * entry for entry in matrix)
        return self._steps[length]

    def advance(self, to_ns: int) -> None:
        a, b, c, d = self._step(to_ns - self.time)
        away = self.x - self.rest
        self.x, self.v, self.time = self.rest + a * away + b * self.v, c * away + d * self.v, to_ns


def reference(spec: Spec, end: int, step: int) -> Floats:
    """Rows (N, 4) of x1, v1, x2, v2 every `step` ns up to `end` ns, correct to rounding.

    For loops of two masses with constant delays above zero, td4 = 0 and h(s) = 1.
    """
    mp.dps = DIGITS
    p, q, face, time = spec.plant, spec.numerical, spec.interface, spec.timing
    assert q is not None and face is not None and time is not None
    k, c, k_tot = mpf(face.stiffness[0]), mpf(face.damping[0]), mpf(spec.k_tot[0])
    at = {name: time.ns(name) for name in ("td1", "td2", "td3", "tau1", "tau2", "tau3", "tau4")}
    one = _Mass(
        mpf(p.mass[0]),
        mpf(p.damping[0]),
        mpf(p.stiffness[0]) + k_tot,
        mpf(p.initial_position[0]),
        mpf(p.initial_velocity[0]),
    )
    two = _Mass(
        mpf(q.mass[0]),
        mpf(q.damping[0]) + c,
        mpf(q.stiffness[0]) + k,
        mpf(q.initial_position[0]),
        mpf(q.initial_velocity[0]),
    )
    k1, k2 = mpf(p.stiffness[0]) + k_tot, mpf(q.stiffness[0]) + k
    first = (one.x, one.v)
    samples: list[tuple[Any, Any]] = []
    force = -c * (one.v - two.v) - k * (one.x - two.x)
    held, cancelled = first, first[0]
    references: dict[int, Any] = {}
    commands: dict[int, Any] = {}
    one.rest = k_tot * (cancelled + force / k_tot) / k1
    two.rest = (k * held[0] + c * held[1]) / k2

    def sample(age: int, now: int) -> tuple[Any, Any]:
        return samples[(now - age) // at["td1"]] if now >= age else first

    rows = []
    for now in _instants(at, end, step):
        one.advance(now)
        two.advance(now)
        if now in commands:
            one.rest = k_tot * commands.pop(now) / k1
        arrived = now in references
        force = references.pop(now, force)
        if now % at["td1"] == 0:
            samples.append((one.x, one.v))
        if now % at["td2"] == 0:
            held = sample(at["tau2"], now)
            two.rest = (k * held[0] + c * held[1]) / k2
            references[now + at["tau3"]] = -c * (held[1] - two.v) - k * (held[0] - two.x)
        if now % at["td3"] == 0:
            cancelled = sample(at["tau1"], now)[0]
        if arrived or now % at["td3"] == 0:
            commands[now + at["tau4"]] = cancelled + force / k_tot
        if now % step == 0:
            rows.append([float(one.x), float(one.v), float(two.x), float(two.v)])
    return np.array(rows)


def _instants(at: dict[str, int], end: int, step: int) -> list[int]:
    """All instants at which anything can happen."""
    ticks = {t for period in (at["td1"], at["td2"], at["td3"], step) for t in range(0, end + 1, period)}
    due = {t + at["tau3"] for t in range(0, end + 1, at["td2"])}
    sent = {t for t in ticks | due if t % at["td3"] == 0 or t in due}
    return sorted(t for t in ticks | due | {t + at["tau4"] for t in sent} if t <= end)
