"""Colour where it means something: the judging words at the beginning of a line, on a terminal."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable

GREEN, YELLOW, RED, PLAIN = "\033[32m", "\033[33m", "\033[31m", "\033[0m"

MEANINGS = {
    GREEN: r"[Ss]table|passed|match|explained|retuned|within [\d.]+ %|Timing did not matter",
    YELLOW: r"warning|improved|Timing mattered|Limits reached|\S+ is cut off",
    RED: r"not stable|Unstable|FAILED|unexplained|Aborted|differs (?:by .*, more than [^:]*|beyond measure)",
}
"""Beginnings of lines that judge, by the colour in which they stand."""

_JUDGING = {colour: re.compile(rf"(?:{words})(?=[:;,. ]|$)") for colour, words in MEANINGS.items()}


def is_coloured() -> bool:
    """Whether standard output is a terminal that wants colour (https://no-color.org)."""
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def coloured(lines: Iterable[str]) -> list[str]:
    r"""The lines, with the judging words at their beginning in colour.

    Examples
    --------
    >>> coloured(["stable: largest eigenvalue 0.98", "tables"])
    ['\x1b[32mstable\x1b[0m: largest eigenvalue 0.98', 'tables']
    """
    return [_coloured(line) for line in lines]


def _coloured(line: str) -> str:
    for colour, judging in _JUDGING.items():
        found = judging.match(line)
        if found:
            return f"{colour}{found[0]}{PLAIN}{line[found.end() :]}"
    return line
