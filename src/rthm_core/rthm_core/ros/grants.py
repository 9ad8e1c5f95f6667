"""Messages of a run in simulated time: what a coordinator grants and what the parts answer.

    grant  coordinator -> part  how far it may work, holding so many messages of each source
    done   part -> coordinator  its next event, and how many messages it has sent of each source

Both are ``std_msgs/Int64MultiArray`` with an empty layout, so that any program can take part:

    virtual/grant/PART  [round, at, rank, messages of SOURCES[0], SOURCES[1], ...]
    virtual/done        [index in PARTS, round, at, rank, messages of SOURCES[0], SOURCES[1], ...]

`at` is in ns after the start of the test and `rank` the rank at this instant (`rthm_core.clock.Rank`). A
grant allows every event before (at, rank); an answer names the part's next event. Round 0 is the greeting of
a part that is ready; a grant that comes again is answered again.
"""

from __future__ import annotations

from struct import Struct, error, unpack_from
from typing import NamedTuple

from rthm_core.ros.agenda import Position
from rthm_core.ros.cdr import ENCAPSULATION
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE, PLANT_STATE

SOURCES = (PLANT_STATE, NUMERICAL_STATE, FORCE_REFERENCE, COMMAND)
"""Topics whose messages are counted, in the order of the counts."""
PARTS = ("plant", "numerical", "actuator", "recorder")
"""Who may take part, in the order of their indices."""
DONE = "virtual/done"
"""Topic of all answers, relative to the namespace of the test."""

Counts = tuple[int, ...]

NOTHING: Counts = (0,) * len(SOURCES)

_HEAD = Struct("<4sIII4x")


def grant_to(part: str) -> str:
    """Topic of the grants to a part, relative to the namespace of the test."""
    return f"virtual/grant/{part}"


class Grant(NamedTuple):
    """Leave to do everything before `bound`, once `messages` of each source are there."""

    round: int
    bound: Position
    messages: Counts

    def message(self) -> bytes:
        """Message to be published."""
        return _pack(self.round, *self.bound, *self.messages)

    @classmethod
    def read(cls, data: bytes) -> Grant:
        """Read a message; ValueError if it is none."""
        round_, at, rank, *messages = _unpack(data, 3)
        return cls(round_, Position(at, rank), tuple(messages))


class Done(NamedTuple):
    """Answer of a part: everything before the bound of `round` is done."""

    part: int
    round: int
    next: Position
    messages: Counts

    def message(self) -> bytes:
        """Message to be published."""
        return _pack(self.part, self.round, *self.next, *self.messages)

    @classmethod
    def read(cls, data: bytes) -> Done:
        """Read a message; ValueError if it is none."""
        part, round_, at, rank, *messages = _unpack(data, 4)
        return cls(part, round_, Position(at, rank), tuple(messages))


def _pack(*numbers: int) -> bytes:
    return _HEAD.pack(ENCAPSULATION, 0, 0, len(numbers)) + Struct(f"<{len(numbers)}q").pack(*numbers)


def _unpack(data: bytes, head: int) -> tuple[int, ...]:
    count = head + len(SOURCES)
    try:
        encapsulation, *layout = _HEAD.unpack_from(data)
        numbers = unpack_from(f"<{count}q", data, _HEAD.size)
    except error:
        raise ValueError("is cut short") from None
    if (encapsulation[:2], layout) != (ENCAPSULATION[:2], [0, 0, count]):
        raise ValueError(f"is not {count} numbers in an empty layout")
    return numbers
