"""How far each part of a run in simulated time may go: no further than what it has not heard of can reach.

A part that has its next event at L sends nothing before L, and what it sends then passes a link in no
less than the link's delay. So the receiver may do everything before L + delay, as soon as it holds all
that was sent:

    sender    ------------------| L: next event
                                 ....delay....
    receiver  --------------------------------| everything before this is safe

A link without delay passes a sample within its instant, after the rank at which it is sent: the receiver
may then do everything up to this rank. So the window of each part follows from the others' next events:
as long as the delays allow, and with delays of zero a round for every instant at which something is
sent.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from rthm_core.clock import Rank
from rthm_core.ros.agenda import Position
from rthm_core.ros.grants import NOTHING, PARTS, SOURCES, Counts, Done, Grant
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec

HELD = 400
"""Messages of one topic that an observer may be behind: less than half of what the topic keeps for it."""
LONGEST_WINDOW = 25
"""Ticks of the fastest clock in the longest window, so that nobody is flooded."""
START = Position(0, 0)
GREETING = Grant(0, START, NOTHING)


@dataclass
class Part:
    """What is known of a part.

    Attributes
    ----------
    next
        Its next event, as far as it knows.
    sent
        Messages that it has sent of each source.
    grant, done
        Its newest grant, and the newest that it has answered; None before its greeting.
    floor
        Place before which it sends nothing while it works on its newest grant.
    ways
        Links on which it receives.
    driven
        Topic whose samples make it act, and so send, as soon as they are due; -1: it acts on its clock alone.
    """

    name: str
    driven: int = -1
    next: Position = START
    sent: Counts = NOTHING
    grant: Grant = GREETING
    done: Grant | None = None
    floor: Position = START
    ways: list[Way] = field(default_factory=list)

    @property
    def idle(self) -> bool:
        """Whether it has answered its newest grant."""
        return self.done is self.grant

    def stirred(self, sent: Counts) -> bool:
        """Whether something that will make it act may be on its way to it."""
        return self.driven >= 0 and sent[self.driven] > self.grant.messages[self.driven]

    def allow(self, bound: Position, sent: Counts) -> Grant:
        """Grant it everything before `bound`."""
        self.floor = self.earliest(sent)
        self.grant = Grant(self.grant.round + 1, bound, sent)
        return self.grant

    def earliest(self, sent: Counts) -> Position:
        """It sends nothing before this place."""
        if self.driven < 0:
            return self.next
        if not self.idle:
            return self.floor
        woken = min(way.reach(way.sender.next) for way in self.ways if way.topic == self.driven)
        return min(self.next, woken, self.grant.bound) if self.stirred(sent) else min(self.next, woken)

    def safe(self, sent: Counts) -> Position:
        """Everything before this place can be done by it."""
        return min([way.reach(way.sender.earliest(sent)) for way in self.ways])

    def behind(self, sent: Counts) -> int:
        """Messages of the busiest topic that it is not known to hold."""
        held = self.done.messages if self.done else NOTHING
        return max(here - there for here, there in zip(sent, held, strict=True))


class Way(NamedTuple):
    """A link on which a part receives: delay in ns, and the ranks at which the sender sends."""

    sender: Part
    topic: int
    delay: int
    ranks: tuple[Rank, ...]

    def reach(self, sends: Position) -> Position:
        """Everything before this place is safe from what the sender sends from `sends` on."""
        if self.delay:
            return Position(sends.at + self.delay, 0)
        later = [rank for rank in self.ranks if rank >= sends.rank]
        return Position(sends.at, later[0] + 1) if later else Position(sends.at + 1, self.ranks[0] + 1)


class LockStep:
    """Grants of one run.

    Parameters
    ----------
    spec
        Its delays.
    until
        Last instant of the test, ns after its start.
    observers
        Who only listens, and may be a little behind.

    Attributes
    ----------
    stopping
        Whether time is to stand still: the loop gets no more grants, and observers what they still miss.
    """

    def __init__(self, spec: Spec, until: int, observers: Sequence[str] = ()) -> None:
        self.stopping = False
        timing = spec.loop().timing
        self._longest = LONGEST_WINDOW * min(timing.ns(name) for name in ("td1", "td2", "td3"))
        self._end = Position(until + 1, 0)
        self._parts = _loop(spec)
        self._observers = [Part(name) for name in observers]
        self._all = {part.name: part for part in (*self._parts, *self._observers)}

    @property
    def finished(self) -> bool:
        """Whether everybody has done everything, and observers have all messages."""
        return self.settled and not self._worth(self._sent())

    @property
    def settled(self) -> bool:
        """Whether nobody is at work, and observers have all messages."""
        sent = self._sent()
        return not self.silent() and not any(o.behind(sent) for o in self._observers)

    @property
    def reached(self) -> int:
        """Instant before which all is done, ns after the start."""
        return min(*(part.next for part in self._parts), self._end).at

    def silent(self) -> dict[str, Grant]:
        """Who has not answered, and the grant in question; grant 0 stands for the greeting."""
        return {name: part.grant for name, part in self._all.items() if not part.idle}

    def hear(self, done: Done) -> None:
        """Note an answer."""
        part = self._all.get(PARTS[done.part])
        if part is not None and done.round == part.grant.round:
            part.next, part.sent, part.done = done.next, done.messages, part.grant

    def advance(self) -> dict[str, Grant]:
        """Make all grants that can be made now, by part."""
        if any(part.done is None for part in self._all.values()):
            return {}
        sent = self._sent()
        backlog = max((observer.behind(sent) for observer in self._observers), default=0)
        made = [] if backlog > HELD or self.stopping else self._worth(sent)
        under_way = any(part.next < self._end for part in self._parts) and not self.stopping
        tolerated = HELD // 2 if under_way else 0
        made += [(o, self._end) for o in self._observers if o.idle and o.behind(sent) > tolerated]
        return {part.name: part.allow(bound, sent) for part, bound in made}

    def _worth(self, sent: Counts) -> list[tuple[Part, Position]]:
        """Bounds of those idle parts that have something to do before them, or may have."""
        found = []
        for part in self._parts:
            longest = Position(part.next.at + self._longest, 0)
            bound = min(part.safe(sent), longest, self._end)
            if part.idle and (part.next < bound or (part.stirred(sent) and part.grant.bound < bound)):
                found.append((part, bound))
        return found or self._last(sent)

    def _last(self, sent: Counts) -> list[tuple[Part, Position]]:
        """When nothing is left to do, all messages are still to be received."""
        if any(not part.idle or part.next < self._end for part in self._parts):
            return []
        return [(part, self._end) for part in self._parts if part.grant.messages != sent]

    def _sent(self) -> Counts:
        return tuple(map(sum, zip(*(part.sent for part in self._parts), strict=True)))


def _loop(spec: Spec) -> tuple[Part, Part, Part]:
    """Make the parts of a loop, and the links between them."""
    state, _, reference, command = range(len(SOURCES))
    schedule = Schedule(spec)
    delay = {name: link.delay_ns for name, link in schedule.links.items()}
    delay["tau4"] += min(schedule.motor_delay, 0)
    plant, numerical = Part("plant"), Part("numerical")
    actuator = Part("actuator", driven=-1 if spec.loop().timing.ns("td4") else reference)
    plant.ways = [Way(actuator, command, delay["tau4"], (Rank.DELAY, Rank.CONTROL))]
    numerical.ways = [Way(plant, state, delay["tau2"], (Rank.SAMPLE,))]
    actuator.ways = [
        Way(plant, state, delay["tau1"], (Rank.SAMPLE,)),
        Way(numerical, reference, delay["tau3"], (Rank.NUMERICAL,)),
    ]
    return plant, numerical, actuator
