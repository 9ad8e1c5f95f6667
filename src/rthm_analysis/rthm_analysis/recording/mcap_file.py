"""Raw messages of an MCAP file, whole or cut off.

The records of an MCAP file stand one after another, and its index comes last. Reading them in this order
needs no index, so a file that a crash cut off is read like any other, up to its last whole record; from a
chunk that was cut, what can still be unpacked is taken.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema

from rthm_analysis.recording.raw import RawBag, RawTopic
from rthm_analysis.recording.unpacking import Allowance
from rthm_core.errors import InputError

MAGIC = b"\x89MCAP0\r\n"
NO_RECORD = 0
"""What no record begins with: a file that a crash left full of zeros ends here."""

_OF_MESSAGE = int(Opcode.MESSAGE)
_HEAD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
_DAMAGE = (
    McapError,
    zstandard.ZstdError,
    struct.error,
    RuntimeError,
    ValueError,
    MemoryError,
    OverflowError,
    EOFError,
)


def read_mcap(path: Path, bag: RawBag) -> None:
    """Add the messages of the file to `bag`, with a note when the file is cut off or damaged.

    Source of the format: the MCAP specification, version 0 (mcap.dev).
    """
    with path.open("rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data:
        reader = _Reader(bag, path.name)
        reader.read(data, len(MAGIC))
    if not reader.complete:
        bag.note(f"{path.name} is cut off, as after a crash of its recorder: all before the cut was read.")
    if reader.damaged:
        bag.note(f"{path.name} is damaged: {reader.damaged} records could not be read and were left out.")


@dataclass
class _Reader:
    bag: RawBag
    file: str
    schemas: dict[int, str] = field(default_factory=dict)
    channels: dict[int, RawTopic | None] = field(default_factory=dict)
    complete: bool = False
    damaged: int = 0

    def read(self, data: bytes | mmap.mmap, at: int) -> None:
        """Take the records of the file, or of an unpacked chunk, from position `at` on."""
        end, topic_of = len(data), self.channels.get
        for opcode, start, stop in _records(data, at):
            try:
                if opcode != _OF_MESSAGE:
                    self._take(opcode, data, start, stop)
                elif stop <= end:
                    channel, _, received_ns, sent_ns = _MESSAGE.unpack_from(data, start)
                    topic = topic_of(channel)
                    if topic is not None:
                        topic.append(received_ns, data[start + _MESSAGE.size : stop], sent_ns)
            except InputError:
                raise
            except _DAMAGE:
                self.damaged += 1

    def _take(self, opcode: int, data: bytes | mmap.mmap, start: int, stop: int) -> None:
        """Take a record that is no message."""
        cut = stop > len(data)
        if opcode == Opcode.CHUNK:
            chunk = Chunk.read(ReadDataStream(BytesIO(data[start:stop])))
            self.read(_unpacked(chunk, cut, self.bag.allowance), 0)
        elif opcode == Opcode.SCHEMA and not cut:
            schema = Schema.read(ReadDataStream(BytesIO(data[start:stop])))
            self.schemas[schema.id] = schema.name
        elif opcode == Opcode.CHANNEL and not cut:
            self._open(Channel.read(ReadDataStream(BytesIO(data[start:stop]))))
        elif opcode == Opcode.FOOTER and not cut:
            self.complete = True

    def _open(self, channel: Channel) -> None:
        if channel.message_encoding != "cdr":
            self.channels[channel.id] = None
            self.bag.note(
                f"{channel.topic} is encoded as {channel.message_encoding!r}, not as CDR: left out."
            )
        else:
            message_type = self.schemas.get(channel.schema_id, "")
            self.channels[channel.id] = self.bag.topic(channel.topic, message_type)


def _records(data: bytes | mmap.mmap, at: int) -> Iterator[tuple[int, int, int]]:
    """Opcode, start and stop of each record; the stop of a record that is cut off lies beyond the data."""
    end = len(data)
    while at + _HEAD.size <= end:
        opcode, length = _HEAD.unpack_from(data, at)
        if opcode == NO_RECORD:
            return
        at += _HEAD.size
        yield opcode, at, at + length
        at += length


def _unpacked(chunk: Chunk, cut: bool, allowance: Allowance) -> bytes:
    allowance.check(chunk.uncompressed_size)
    if chunk.compression == "zstd":
        records = allowance.zstd(chunk.data)
    elif chunk.compression == "lz4":
        records = allowance.lz4(chunk.data)
    elif chunk.compression == "":
        records = chunk.data
    else:
        raise ValueError(chunk.compression)
    if not cut and chunk.uncompressed_crc not in (0, zlib.crc32(records)):
        raise ValueError("checksum")
    return records
