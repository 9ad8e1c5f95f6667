"""Limits that the leader watches on the graph: one publisher for each topic, and clocks that agree."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping, Sequence

from rthm_actuator.supervision import Broken
from rthm_core.clocks import LIMIT as CLOCK
from rthm_core.clocks import Comparison, Exchange, Offset
from rthm_core.owner import LIMIT as OWNER
from rthm_core.owner import second_owner

EVERY, ASK, TELL = 0.02, 0.05, 0.5
"""Time between two looks at the graph, two questions for the time, and two messages about clocks, s."""


class ClockWatch:
    """Compares the clocks of parts on other hosts with the leader's, twenty times a second.

    Parameters
    ----------
    names
        Nodes that are asked.
    limit
        Largest offset that is allowed, s.
    ask
        Asks them all.
    tell
        Told all offsets twice a second.
    now
        Time, s.
    """

    def __init__(
        self,
        names: Collection[str],
        limit: float,
        ask: Callable[[], None],
        tell: Callable[[Mapping[str, Offset]], None],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._names, self._limit, self._ask, self._tell, self._now = names, limit, ask, tell, now
        self._compared: dict[str, Comparison] = {}
        self._next = self._next_told = 0.0

    @property
    def offsets(self) -> dict[str, Offset]:
        """Offsets by the last exchanges with each node that answers."""
        return {name: compared.best() for name, compared in self._compared.items()}

    def take(self, name: str, exchange: Exchange) -> None:
        """Take notice of an exchange with a node."""
        if name in self._names:
            self._compared.setdefault(name, Comparison()).add(exchange)

    def look(self) -> None:
        """Ask, and tell, if it is time."""
        if self._names and self._now() >= self._next:
            self._next = self._now() + ASK
            self._ask()
        if self._compared and self._now() >= self._next_told:
            self._next_told = self._now() + TELL
            self._tell(self.offsets)

    def broken(self) -> Broken | None:
        """Return the limit that an offset breaks, if one certainly does."""
        for name, one in self.offsets.items():
            if one.beyond(self._limit):
                words = _words(name, one, self._limit)
                return Broken(CLOCK, abs(one.offset), self._limit, words)
        return None


class OwnerWatch:
    """Looks whether each topic of the loop has one publisher.

    Parameters
    ----------
    publishers
        Full names of the nodes that publish each topic that has more than one publisher.
    now
        Time, s.
    """

    def __init__(
        self,
        publishers: Callable[[], Mapping[str, Sequence[str]]],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._publishers, self._now, self._next = publishers, now, 0.0

    def broken(self) -> Broken | None:
        """Return the limit that a second publisher broke; looks at most once in `EVERY`."""
        if self._now() < self._next:
            return None
        self._next = self._now() + EVERY
        found = self._publishers()
        words = second_owner(found)
        return Broken(OWNER, max(map(len, found.values())), 1, words) if words else None


def _words(name: str, one: Offset, limit: float) -> str:
    found = f"{abs(one.offset) * 1e3:.3f} ms (+- {one.uncertainty * 1e3:.3f} ms)"
    ahead = "ahead of" if one.offset > 0.0 else "behind"
    return (
        f"the clock of {name} is {found} {ahead} this host's, but may be {limit * 1e3:.3g} ms off;"
        " synchronise the hosts, raise limits.clock, or go on with --allow-clock-offset"
    )
