"""Bags that unpack to more than any recording does are refused at once."""

from __future__ import annotations

import struct
from io import BytesIO
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Chunk

from rthm_analysis.recording import read_recording
from rthm_analysis.recording.unpacking import FREE, RATIO, Allowance
from rthm_core.errors import InputError

MAGIC = b"\x89MCAP0\r\n"
HUGE = 10 << 30
REFUSED = r"has \d+\.\d MB and unpacks to over \d+ MB, .*; give another one\.$"


def zeros(size: int) -> bytes:
    """So many zeros, packed with zstd, without ever being there."""
    packed, out, piece = zstandard.ZstdCompressor().compressobj(), [], bytes(1 << 24)
    for _ in range(size // len(piece)):
        out.append(packed.compress(piece))
    return b"".join([*out, packed.flush()])


def bag(path: Path, *chunks: Chunk) -> Path:
    record = RecordBuilder()
    for chunk in chunks:
        chunk.write(record)
    path.write_bytes(MAGIC + record.end())
    return path


def chunk(data: bytes, compression: str, declared: int) -> Chunk:
    return Chunk(
        compression=compression, data=data, message_end_time=1, message_start_time=0,
        uncompressed_crc=0, uncompressed_size=declared,
    )  # fmt: skip


@pytest.mark.parametrize("declared", [HUGE, 100], ids=["as much as it has", "far less"])
def test_a_small_bag_with_a_huge_block_is_refused_without_unpacking_it(tmp_path: Path, declared: int) -> None:
    path = bag(tmp_path / "x.mcap", chunk(zeros(1 << 30), "zstd", declared))
    with pytest.raises(InputError, match=REFUSED):
        read_recording(path)


def test_many_blocks_are_refused_as_one_is(tmp_path: Path) -> None:
    one = chunk(lz4.frame.compress(bytes(FREE // 3)), "lz4", FREE // 3)
    with pytest.raises(InputError, match=REFUSED):
        read_recording(bag(tmp_path / "x.mcap", *[one] * 40))


def test_blocks_within_blocks_spend_the_same_allowance(tmp_path: Path) -> None:
    inner = RecordBuilder()
    chunk(zeros(1 << 30), "zstd", 0).write(inner)
    packed = zstandard.compress(inner.end())
    with pytest.raises(InputError, match=REFUSED):
        read_recording(bag(tmp_path / "x.mcap", chunk(packed, "zstd", 0)))


def test_a_file_that_was_packed_as_a_whole_is_refused_too(tmp_path: Path) -> None:
    whole = tmp_path / "x.mcap.zstd"
    whole.write_bytes(zeros(1 << 30))
    with pytest.raises(InputError, match=REFUSED):
        read_recording(whole)


def test_a_block_of_nothing_but_zeros_holds_no_records(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no message that can be read"):
        read_recording(bag(tmp_path / "x.mcap", chunk(zeros(FREE // 2), "zstd", FREE // 2)))


def test_what_may_be_unpacked_grows_with_the_files() -> None:
    allowance = Allowance("a bag")
    allowance.grant(1_000_000)
    allowance.spend(RATIO * 1_000_000)
    with pytest.raises(InputError, match=r"a bag has 1\.0 MB and unpacks to over 200 MB"):
        allowance.spend(1)


def test_what_is_allowed_is_unpacked_whole() -> None:
    data = struct.pack("<1000Q", *range(1000))
    allowance = Allowance()
    assert allowance.zstd(zstandard.compress(data)) == data
    assert allowance.lz4(lz4.frame.compress(data)) == data
    assert b"".join(allowance.zstd_pieces(BytesIO(zstandard.compress(data)))) == data
    assert allowance.left == FREE - 3 * len(data)
