"""Unpack what a bag holds compressed, but no more than a recording of its size can hold.

A megabyte can unpack to gigabytes of nothing, and would keep a reader busy for minutes.
"""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

import lz4.frame
import zstandard

from rthm_core.errors import InputError

RATIO = 200
"""Unpacked bytes for each byte of a file; samples that differ in their stamps alone need 30."""

FREE = 64_000_000
"""Bytes that any bag may unpack to."""

_PIECE = 1 << 20


class Allowance:
    """How much a bag may still unpack to.

    Parameters
    ----------
    path
        The bag, for the sentence.
    """

    def __init__(self, path: str | Path = "the bag") -> None:
        self._path = path
        self.grant(0)

    def grant(self, size: int) -> None:
        """Allow what files of `size` bytes in all may hold."""
        self._size = size
        self.left = self._most = max(FREE, RATIO * size)

    def spend(self, count: int) -> None:
        """Take away so many bytes, or refuse the bag.

        Raises
        ------
        InputError
            If less is left.
        """
        self.left -= count
        if self.left < 0:
            raise InputError(
                f"{self._path} has {self._size / 1e6:.1f} MB and unpacks to over {self._most / 1e6:.0f} MB,"
                " as no recording does: it is damaged or made to do harm, and is not read; give another one."
            )

    def check(self, count: int) -> None:
        """Refuse the bag if it declares a block of more bytes than are left."""
        if count > self.left:
            self.spend(count)

    def zstd(self, data: bytes) -> bytes:
        """Unpack; what comes before damage in a block that is cut off is returned."""
        return b"".join(self.zstd_pieces(BytesIO(data)))

    def zstd_pieces(self, stream: IO[bytes]) -> Iterator[bytes]:
        """Unpack a stream piece by piece."""
        for piece in zstandard.ZstdDecompressor().read_to_iter(stream, write_size=_PIECE):
            self.spend(len(piece))
            yield piece

    def lz4(self, data: bytes) -> bytes:
        """Unpack."""
        unpacked = lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=self.left + 1)
        self.spend(len(unpacked))
        return bytes(unpacked)
