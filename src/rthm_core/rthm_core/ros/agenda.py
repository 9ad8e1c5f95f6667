"""What a node does next: ticks of its clocks, and samples whose delay is over.

The same agenda runs in real time (`rthm_core.ros.realtime_loop`) and in granted windows of simulated time
(`rthm_core.ros.virtual`). All instants are ns after the start of the test.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from rthm_core.clock import Rank

NEVER = 2**62
"""An instant that no test reaches."""

Action = Callable[[int, int], None]
"""``action(at, now)``: do what is due at the instant `at`; it is really done at `now`, never before `at`."""


class Position(NamedTuple):
    """Place in the event order: the instant, then the rank at this instant."""

    at: int
    rank: int


class Waiting(Protocol):
    """Samples that wait for the end of their delay."""

    def next_due(self) -> int | None:
        """Instant at which the next delay is over."""
        ...

    def next_stamp(self) -> int | None:
        """Stamp of the sample whose delay is over then."""
        ...


class Ticks:
    """Ticks of one clock, and how punctually they were done.

    Parameters
    ----------
    skips
        Whether a tick is left out when the next one is due as well.

    Attributes
    ----------
    done, missed
        Ticks that are over, and those of them that were left out or ended only after the next one was due.
    lateness
        Longest time from a tick's instant to the beginning of its work since `clear`, ns.
    """

    def __init__(self, name: str, period: int, rank: int, action: Action, skips: bool = False) -> None:
        self.name, self.period, self.rank, self.action = name, period, rank, action
        self.skips = skips
        self.done = self.missed = self.lateness = 0

    def position(self) -> Position:
        """Place of the next tick."""
        return Position(self.done * self.period, self.rank)

    def skip(self, now: int) -> None:
        """Leave out all ticks but the newest one that is due at `now`."""
        late = now // self.period - self.done
        if self.skips and late > 0:
            self.missed += late
            self.done += late

    def run(self, at: int, now: int) -> None:
        """Do the tick."""
        self.done += 1
        self.action(at, now)

    def judge(self, at: int, began: int, ended: int) -> None:
        """Note when the tick at `at` began and ended."""
        self.lateness = max(self.lateness, began - at)
        self.missed += ended > at + self.period


class Delays:
    """Ends of the delays of samples that wait in an inbox."""

    def __init__(self, inbox: Waiting, action: Action, sent_at: Callable[[int], Rank]) -> None:
        self._inbox, self.run, self._sent_at = inbox, action, sent_at

    def position(self) -> Position:
        """Place at which the next delay is over."""
        due, stamp = self._inbox.next_due(), self._inbox.next_stamp()
        if due is None or stamp is None:
            return Position(NEVER, 0)
        return Position(due, self._sent_at(stamp) if due == stamp else Rank.DELAY)

    def judge(self, at: int, began: int, ended: int) -> None:
        """Lateness of a sample is told by the use of the sample itself."""


class Agenda:
    """Events of one node in the order of the contract.

    Parameters
    ----------
    until
        Last instant at which something is done, ns; 0: no end.
    """

    def __init__(self, until: int = 0) -> None:
        self._entries: list[Ticks | Delays] = []
        self._until = until or NEVER - 1
        self.clocks: list[Ticks] = []

    def every(self, name: str, period: int, rank: Rank, action: Action, skips: bool = False) -> Ticks:
        """Do `action` at every tick of the clock `name` with this period (ns), the first one at the start.

        Parameters
        ----------
        skips
            Whether ticks are left out, in real time, when newer ones are due as well: nothing is caught up.
        """
        clock = Ticks(name, period, rank, action, skips)
        self.clocks.append(clock)
        self._entries.append(clock)
        return clock

    def when_due(
        self, inbox: Waiting, action: Action, sent_at: Callable[[int], Rank] = lambda stamp: Rank.DELAY
    ) -> None:
        """Do `action` whenever the delay of a sample in `inbox` is over; it has to take the sample out.

        Parameters
        ----------
        sent_at
            Rank at which a sample of this stamp is sent: without a delay it is there right after.
        """
        self._entries.append(Delays(inbox, action, sent_at))

    def skip(self, now: int) -> None:
        """Leave out, in the clocks that skip, what is no longer worth doing at `now`."""
        for clock in self.clocks:
            clock.skip(min(now, self._until))

    def next(self) -> Position:
        """Place of the next event; `NEVER` when none is left."""
        return self._earliest()[0]

    def run(self, now: int) -> tuple[int, Ticks | Delays]:
        """Do the next event, which must be due; return its instant and what it belonged to."""
        (at, _), entry = self._earliest()
        entry.run(at, max(now, at))
        return at, entry

    def _earliest(self) -> tuple[Position, Ticks | Delays]:
        best, chosen = Position(NEVER, 0), self._entries[0]
        for entry in self._entries:
            position = entry.position()
            if position < best and position.at <= self._until:
                best, chosen = position, entry
        return best, chosen
