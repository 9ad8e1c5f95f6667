"""A link: how long a sample is under way, whether it arrives, and which sample a receiver holds.

A newer sample replaces an older one; an older one that arrives after a newer one is dropped. All instants are
ns since the start of the test.
"""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_core.chance import normal, uniform
from rthm_core.clock import to_ns
from rthm_core.compiled import Integers
from rthm_core.spec.effect import sizes

if TYPE_CHECKING:
    from rthm_core.effects.declaration import Change
    from rthm_core.spec import Spec

NEVER = np.iinfo(np.int64).max
"""Due time of a sample that is lost."""


class Link:
    """One of the links tau1 .. tau4 of a spec.

    Parameters
    ----------
    spec : Spec
        A complete loop.
    name : str
        ``"tau1"`` (state to controller), ``"tau2"`` (state to numerical substructure), ``"tau3"`` (reference
        to controller) or ``"tau4"``
        (command to motor).

    Attributes
    ----------
    delay_ns : int
        Constant part of the delay: tau, what effects add to it, and by what they move the stamps.
    beside_ns : int
        The latter two, of either sign.
    offset_ns : int
        By how much the stamps of arriving samples are ahead; the receiver waits for them in its own clock.
    """

    def __init__(self, spec: Spec, name: str) -> None:
        self.name = name
        timing = spec.loop().timing

        def total(changes: Change) -> float:
            return sum(sizes(spec.effects, f"link.{name}", changes))

        self.offset_ns = to_ns(total("stamps"))
        self.beside_ns = to_ns(total("delay")) + self.offset_ns
        self.delay_ns = max(0, timing.ns(name) + self.beside_ns)
        self.jitter = total("spread")
        self.loss = total("lost")
        self._seed = int(spec.noise.seed)

    @property
    def constant(self) -> bool:
        """Whether every sample takes the same time and arrives."""
        return self.jitter == 0.0 and self.loss == 0.0

    @property
    def reach_ns(self) -> int:
        """Longest time that a sample that arrives can be under way."""
        return self.delay_ns + to_ns(9.0 * self.jitter)

    def due_all(self, stamps_ns: Integers) -> Integers:
        """Due times of samples stamped `stamps_ns`; `NEVER` for those that are lost."""
        stamps = np.asarray(stamps_ns, dtype=np.int64)
        due = stamps + self.delay_ns
        if self.jitter > 0.0:
            further = normal(self._seed, f"link.{self.name}.jitter", stamps)
            np.abs(further, out=further)
            further *= self.jitter
            further *= 1e9
            due += np.rint(further, out=further).astype(np.int64)
        if self.loss > 0.0:
            due = np.where(uniform(self._seed, f"link.{self.name}.loss", stamps) < self.loss, NEVER, due)
        return due

    def due(self, stamp_ns: int) -> int | None:
        """Due time of one sample; None when it is lost."""
        if self.constant:
            return stamp_ns + self.delay_ns
        due = int(self.due_all(np.array([stamp_ns]))[0])
        return None if due == NEVER else due


class Inbox:
    """Samples that wait in the receiver until they are due.

    Attributes
    ----------
    lost, late, dropped : int
        Samples that the link lost, that came after they were due, and that a newer one had overtaken.
    """

    def __init__(self) -> None:
        self._waiting: list[tuple[int, int, Any]] = []
        self._newest = -1
        self.lost = self.late = self.dropped = 0

    def push(self, stamp_ns: int, due_ns: int | None, payload: Any, now_ns: int | None = None) -> None:
        """Take a sample in; ``due_ns=None``: the link lost it. With `now_ns`, a sample whose due time is over
        counts as late.
        """
        if due_ns is None:
            self.lost += 1
            return
        if now_ns is not None and now_ns > due_ns:
            self.late += 1
        heapq.heappush(self._waiting, (due_ns, stamp_ns, payload))

    def next_due(self) -> int | None:
        """Instant at which the next waiting sample is due."""
        return self._waiting[0][0] if self._waiting else None

    def next_stamp(self) -> int | None:
        """Stamp of the sample that is due next."""
        return self._waiting[0][1] if self._waiting else None

    def take(self, now_ns: int) -> tuple[int, Any] | None:
        """Stamp and payload of the newest sample that has come due by `now_ns` since the last call; None when
        there is none newer than what was taken.
        """
        taken = None
        while self._waiting and self._waiting[0][0] <= now_ns:
            _, stamp, payload = heapq.heappop(self._waiting)
            if stamp > self._newest:
                self.dropped += taken is not None
                self._newest, taken = stamp, (stamp, payload)
            else:
                self.dropped += 1
        return taken
