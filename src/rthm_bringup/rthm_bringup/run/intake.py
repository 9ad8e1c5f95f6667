"""What of the messages received goes into the bag, when each was received, and whether any is missing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from struct import Struct
from typing import NamedTuple, TypeGuard

from rthm_analysis.recording.writing import BagWriter
from rthm_core.clock import NS
from rthm_core.ros.polling import Info
from rthm_core.topics import LOOP, PLANT_STATE, SPEC, STRING

_STAMP = Struct("<iI")  # of a header, behind the four bytes of encapsulation
_UNKNOWN = 2**63  # a middleware that does not number messages gives the largest integer


class Numbered(NamedTuple):
    """Number that a publisher gave to a message, and the message's stamp, ns."""

    number: int
    stamp: int


@dataclass
class Intake:
    """Sorts messages into a bag.

    Parameters
    ----------
    writer
        The bag.
    names
        Full name of every topic by its relative name.
    virtual
        Whether the test runs in simulated time: a message is then received and sent at its stamp.

    Attributes
    ----------
    lost : int
        Samples of the test that were published and never received.
    twice : int
        Samples of the plant that came again, with the stamp of the one before.
    """

    writer: BagWriter
    names: dict[str, str]
    virtual: bool = False
    begin: int | None = None
    end: int | None = None
    lost: int = 0
    twice: int = 0
    _latest: int = 0
    _numbered: dict[str, Numbered] = field(default_factory=dict)
    _stamps: dict[str, int] = field(default_factory=dict)

    def open(self, begin: int, end: int | None) -> None:
        """Take samples of the loop stamped from `begin` to `end` (ns); None: until closed."""
        self.begin, self.end = begin, end
        self._stamps.clear()

    def behind(self, periods: Mapping[str, int]) -> list[str]:
        """Say which topics have not come to the end of the test yet.

        Parameters
        ----------
        periods
            Distance of the samples of a topic, ns.
        """
        if self.begin is None or self.end is None:
            return []
        newest = {topic: self._stamps.get(topic, self.begin) for topic in periods}
        return [
            f"{topic} ends {(self.end - stamp) / NS:.3f} s before the end of the test"
            for topic, stamp in newest.items()
            if stamp + periods[topic] <= self.end
        ]

    def put_spec(self, text: str, now: int) -> None:
        """Write the spec, before anything else."""
        data = text.encode() + b"\x00"
        message = b"\x00\x01\x00\x00" + len(data).to_bytes(4, "little") + data
        self.writer.add_topic(self.names[SPEC], STRING, depth=1, latched=True)
        self.writer.write(self.names[SPEC], STRING, message, now, now)

    def take(self, topic: str, type_name: str, data: bytes, info: Info) -> None:
        """Write a message of the topic with this relative name, unless it lies outside of the test."""
        number = info["publication_sequence_number"]
        stamp = _stamp(data)
        if topic in LOOP:
            self._count(topic, number, stamp)
            again = topic == PLANT_STATE and stamp == self._stamps.get(topic)
            self._stamps[topic] = max(stamp, self._stamps.get(topic, 0))
            if not self._within(stamp):
                return
            self.twice += again
        received, sent = info["received_timestamp"], info["source_timestamp"]
        if self.virtual:
            received = sent = self._simulated(topic, stamp)
        self.writer.write(
            self.names[topic], type_name, data, received, sent, number if _known(number) else None
        )

    def _simulated(self, topic: str, stamp: int) -> int:
        """Time of a message when time is simulated: who only watches may stamp with another clock."""
        if topic in LOOP:
            self._latest = max(self._latest, stamp)
            return stamp
        return self._latest

    def _within(self, stamp: int) -> bool:
        return self.begin is not None and self.begin <= stamp and (self.end is None or stamp <= self.end)

    def _count(self, topic: str, number: int | None, stamp: int) -> None:
        """Count what is missing before this message, as far as it belongs to the test.

        A driver publishes also before a test, while the nodes start and the machine is busy.
        """
        if not _known(number):
            return
        newest, this = self._numbered.get(topic), Numbered(number, stamp)
        if newest is None or this.number > newest.number:
            self._numbered[topic] = this
        if newest is not None:
            self.lost += sum(self._within(missing) for missing in stamps_between(newest, this))


def stamps_between(before: Numbered, after: Numbered) -> list[int]:
    """Stamps (ns) of the messages missing between two, which lie at equal distances."""
    steps = after.number - before.number
    return [before.stamp + (after.stamp - before.stamp) * k // steps for k in range(1, steps)]


def _known(number: int | None) -> TypeGuard[int]:
    return number is not None and number < _UNKNOWN


def _stamp(data: bytes) -> int:
    seconds, nanoseconds = _STAMP.unpack_from(data, 4)
    return int(seconds) * NS + int(nanoseconds)
