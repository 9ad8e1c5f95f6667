"""Decode the three message types of a recording from CDR, all messages of one layout at once.

Between two messages of one topic only the numbers change; names and lengths stay. The first message of a
size is read step by step, which gives the layout; every message that agrees with it in names and lengths is
then decoded by one array operation.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from rthm_analysis.recording.raw import Bytes, RawTopic
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers

FIELDS = ("position", "velocity", "effort")

L = TypeVar("L", bound="Layout")


@dataclass
class Layout:
    """Where things are in a message: byte order, and the bytes that every message of this layout shares."""

    order: str
    fixed: list[slice] = field(default_factory=list)


@dataclass
class JointLayout(Layout):
    """Layout of sensor_msgs/JointState: names, and offset and length of each array of numbers."""

    names: list[str] = field(default_factory=list)
    numbers: dict[str, tuple[int, int]] = field(default_factory=dict)


@dataclass
class ReferenceLayout(Layout):
    """Layout of sensor_msgs/TimeReference: offset of time_ref."""

    reference: int = 0


@dataclass(frozen=True)
class JointBlock:
    """Decoded messages of one layout: ``values[field]`` has shape (messages, length of the field)."""

    indices: Integers
    stamp_ns: Integers
    names: list[str]
    values: dict[str, Floats]


@dataclass(frozen=True)
class ReferenceBlock:
    """Decoded time references: instant of use and stamp of the sample used."""

    indices: Integers
    use_ns: Integers
    sample_ns: Integers


class _Cursor:
    """Reads one CDR message from its start and remembers which bytes a layout fixes."""

    def __init__(self, message: bytes) -> None:
        if len(message) < 12 or message[0] != 0 or message[1] > 1:
            raise ValueError("not plain CDR")
        self.message, self.at = message, 4
        self.order = "<" if message[1] == 1 else ">"
        self.fixed = [slice(0, 2)]

    def _aligned(self, size: int) -> int:
        self.at += -(self.at - 4) % size
        return self.at

    def time(self) -> int:
        start = self._aligned(4)
        self.skip(8)
        return start

    def count(self) -> int:
        start = self._aligned(4)
        self.skip(4)
        self.fixed.append(slice(start, self.at))
        (count,) = struct.unpack_from(self.order + "I", self.message, start)
        return int(count)

    def free_string(self) -> None:
        self.skip(self.count())

    def string(self) -> str:
        length = self.count()
        start = self.at
        self.skip(length)
        self.fixed.append(slice(start, self.at))
        return self.message[start : self.at].rstrip(b"\x00").decode("utf-8", "replace")

    def doubles(self) -> tuple[int, int]:
        length = self.count()
        start = self._aligned(8) if length else self.at
        self.skip(8 * length)
        return start, length

    def skip(self, size: int) -> None:
        self.at += size
        if self.at > len(self.message):
            raise ValueError("message ends too early")


def _joint_layout(message: bytes) -> JointLayout:
    cursor = _Cursor(message)
    cursor.time()
    cursor.free_string()
    names = [cursor.string() for _ in range(cursor.count())]
    numbers = {name: cursor.doubles() for name in FIELDS}
    return JointLayout(cursor.order, cursor.fixed, names, numbers)


def _reference_layout(message: bytes) -> ReferenceLayout:
    cursor = _Cursor(message)
    cursor.time()
    cursor.free_string()
    reference = cursor.time()
    cursor.free_string()
    return ReferenceLayout(cursor.order, cursor.fixed, reference)


def decode_joint_states(topic: RawTopic) -> Iterator[JointBlock]:
    """Blocks of decoded JointStates; messages that are not JointStates are left out."""
    for layout, indices, rows in _by_layout(topic, _joint_layout):
        places = layout.numbers.items()
        values = {name: _numbers(rows, start, length, layout.order) for name, (start, length) in places}
        yield JointBlock(indices, _times(rows, 4, layout.order), layout.names, values)


def decode_time_references(topic: RawTopic) -> Iterator[ReferenceBlock]:
    """Blocks of decoded TimeReferences; messages that are not TimeReferences are left out."""
    for layout, indices, rows in _by_layout(topic, _reference_layout):
        uses, samples = _times(rows, 4, layout.order), _times(rows, layout.reference, layout.order)
        yield ReferenceBlock(indices, uses, samples)


def decode_string(message: bytes) -> str:
    """Text of a std_msgs/String.

    Raises
    ------
    ValueError
        The bytes are not such a message.
    """
    try:
        return _Cursor(message + b"\x00" * 8).string()
    except struct.error:
        raise ValueError("not a std_msgs/String") from None


def decode_diagnostics(message: bytes) -> dict[str, dict[str, str]]:
    """Values of every status of a diagnostic_msgs/DiagnosticArray, by the name of the status and the key.

    Raises
    ------
    ValueError
        The bytes are not such a message.
    """
    try:
        cursor = _Cursor(message)
        cursor.time()
        cursor.free_string()
        return dict(_status(cursor) for _ in range(cursor.count()))
    except struct.error:
        raise ValueError("not a diagnostic_msgs/DiagnosticArray") from None


def _status(cursor: _Cursor) -> tuple[str, dict[str, str]]:
    cursor.skip(1)
    name = cursor.string()
    cursor.free_string()
    cursor.free_string()
    return name, {cursor.string(): cursor.string() for _ in range(cursor.count())}


def _by_layout(topic: RawTopic, read: Callable[[bytes], L]) -> Iterator[tuple[L, Integers, Bytes]]:
    for indices, rows in topic.by_size():
        while indices.size:
            try:
                layout = read(rows[0].tobytes())
            except (ValueError, struct.error):
                indices, rows = indices[1:], rows[1:]
                continue
            agreeing = [(rows[:, part] == rows[0, part]).all(axis=1) for part in layout.fixed]
            alike = np.logical_and.reduce(agreeing)
            yield layout, indices[alike], rows[alike]
            indices, rows = indices[~alike], rows[~alike]


def _numbers(rows: Bytes, start: int, length: int, order: str) -> Floats:
    if length == 0:
        return np.empty((len(rows), 0))
    part = np.ascontiguousarray(rows[:, start : start + 8 * length])
    return part.view(f"{order}f8").astype(np.float64).reshape(len(rows), length)


def _times(rows: Bytes, start: int, order: str) -> Integers:
    part = np.ascontiguousarray(rows[:, start : start + 8])
    seconds = part[:, :4].copy().view(f"{order}i4")[:, 0].astype(np.int64)
    nanoseconds = part[:, 4:].copy().view(f"{order}u4")[:, 0].astype(np.int64)
    return seconds * NS + nanoseconds
