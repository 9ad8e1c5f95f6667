"""Messages of a bag as they are stored: bytes and times of reception, nothing decoded."""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.recording.unpacking import Allowance

if TYPE_CHECKING:
    from rthm_core.compiled import Integers


ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
LARGEST = 0x7FFF_FFFF_FFFF_FFFF

Bytes = np.ndarray[tuple[int, int], np.dtype[np.uint8]]


@dataclass
class RawTopic:
    """Messages of one topic in the order of the recording, end to end in one buffer.

    Most topics have messages of one size, so that the buffer is a table already.
    """

    name: str
    type: str
    data: bytearray = field(default_factory=bytearray)
    sizes: array[int] = field(default_factory=lambda: array("Q"))
    received: array[int] = field(default_factory=lambda: array("Q"))
    sent: array[int] = field(default_factory=lambda: array("Q"))
    allowance: Allowance = field(default_factory=Allowance)

    def append(self, received_ns: int, payload: bytes, sent_ns: int | None = None) -> None:
        """Add a message; one that rosbag2 compressed by itself is unpacked. None: not known when sent."""
        if payload[:4] == ZSTD_MAGIC:
            payload = _unpacked(payload, self.allowance)
        self.data += payload
        self.sizes.append(len(payload))
        self.received.append(received_ns & LARGEST)
        self.sent.append((sent_ns or received_ns) & LARGEST)

    def __len__(self) -> int:
        return len(self.sizes)

    @property
    def received_ns(self) -> Integers:
        """Times of reception by the recorder, shape (messages,)."""
        return np.array(self.received, dtype=np.int64)

    @property
    def sent_ns(self) -> Integers:
        """Times of sending by the source, shape (messages,); those of reception where they are not known."""
        return np.array(self.sent, dtype=np.int64)

    def last_messages(self, count: int) -> Iterator[bytes]:
        """Yield the bytes of the last `count` messages, in order."""
        start = sum(self.sizes[:-count])
        for size in self.sizes[-count:]:
            yield bytes(self.data[start : start + size])
            start += size

    def by_size(self) -> Iterator[tuple[Integers, Bytes]]:
        """Yield, for each size, indices and bytes (messages, size) of all messages of that size."""
        sizes = np.array(self.sizes, dtype=np.int64)
        buffer = np.frombuffer(self.data, dtype=np.uint8)
        starts = np.cumsum(sizes) - sizes
        for size in np.unique(sizes):
            indices = np.flatnonzero(sizes == size)
            if indices.size == sizes.size:
                yield indices, buffer.reshape(indices.size, size)
            else:
                yield indices, buffer[starts[indices, None] + np.arange(size)]


@dataclass
class RawBag:
    """All topics of a bag by name, and what had to be said while it was read."""

    allowance: Allowance = field(default_factory=Allowance)
    topics: dict[str, RawTopic] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def topic(self, name: str, message_type: str) -> RawTopic:
        """Return the topic of this name, made at its first message; one name has one type."""
        return self.topics.setdefault(name, RawTopic(name, message_type, allowance=self.allowance))

    def note(self, sentence: str) -> None:
        """Remember something that the user should know, once."""
        if sentence not in self.notes:
            self.notes.append(sentence)


def _unpacked(payload: bytes, allowance: Allowance) -> bytes:
    import zstandard

    try:
        return allowance.zstd(payload)
    except (zstandard.ZstdError, MemoryError):
        return b""
