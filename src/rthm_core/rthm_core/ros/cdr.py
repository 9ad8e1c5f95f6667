"""Plain CDR (DDS-XTypes 1.3, section 7.4.1), as far as the messages of the loop need it.

Every number is aligned to its own size, counted from the end of the four-byte encapsulation header; a
string or an array is preceded by its length. Positions named `at` count from that end when bytes are
written, and from the start of the message when it is read.
"""

from __future__ import annotations

from collections.abc import Sequence
from struct import unpack_from

ENCAPSULATION = b"\x00\x01\x00\x00"
"""Header of little-endian plain CDR."""


def string(text: str) -> bytes:
    """Length and zero-terminated text."""
    data = text.encode() + b"\0"
    return len(data).to_bytes(4, "little") + data


def strings(texts: Sequence[str], at: int) -> bytes:
    """Sequence of strings that begins at `at`."""
    out = bytearray(-at % 4)
    out += len(texts).to_bytes(4, "little")
    for text in texts:
        out += bytes(-(at + len(out)) % 4) + string(text)
    return bytes(out)


def array_layout(at: int, count: int) -> str:
    """Struct layout of a sequence of doubles that begins at `at`: its count, then the values."""
    gap = -at % 4
    return f"{gap}xI" + (f"{-(at + gap + 4) % 8}x{count}d" if count else "")


def end_of_array(at: int, count: int) -> int:
    """Position after a sequence of `count` doubles that begins at `at`."""
    after = at + -at % 4 + 4
    return after + -after % 8 + 8 * count if count else after


class Walk:
    """Reading position in a message, from behind its encapsulation header.

    Raises
    ------
    ValueError
        If the message is not plain CDR or ends too early.
    """

    def __init__(self, data: bytes) -> None:
        if len(data) < 12 or data[0] != 0 or data[1] > 1:
            raise ValueError("is not plain CDR")
        self.data = data
        self.order = "<" if data[1] else ">"
        self.at = 4

    def count(self) -> int:
        """Length of what follows."""
        self.at += -self.at % 4
        start = self._pass(4)
        return int(unpack_from(self.order + "I", self.data, start)[0])

    def string(self) -> str:
        """Next string."""
        start = self._pass(self.count())
        return self.data[start : self.at].rstrip(b"\0").decode(errors="replace")

    def doubles(self) -> int:
        """Pass a sequence of doubles; return how many it has."""
        count = self.count()
        if count:
            self.at += -(self.at - 4) % 8
        self._pass(8 * count)
        return count

    def _pass(self, size: int) -> int:
        start, self.at = self.at, self.at + size
        if self.at > len(self.data):
            raise ValueError("is cut short")
        return start
