"""How long work will take: announced before it has taken hours, and asked about on a terminal."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path

import typer

LOOKED = 10.0
"""Time after which the pace of some work is known, s."""

LONG = 3600.0
"""Time from which on work is announced, s."""

UNITS = ("B", "kB", "MB", "GB", "TB", "PB", "EB")


class Pace:
    """Follows how much is done, and once says how long the rest takes, if that is long.

    Parameters
    ----------
    total : float
        What is done at the end.
    ask : callable, optional
        Gets the sentence and says whether to go on; by default `asked`.
    clock : callable
        s.
    size : callable, optional
        Gets the share that is done and says how large the whole is, as the end of the sentence.
    resumes : bool
        Whether what is first told was done before, and took no time.
    """

    def __init__(
        self,
        total: float,
        ask: Callable[[str], bool] | None = None,
        clock: Callable[[], float] = time.monotonic,
        size: Callable[[float], str] | None = None,
        resumes: bool = False,
    ) -> None:
        self._total, self._ask, self._clock, self._size = total, ask or asked, clock, size
        self._before: float | None = None if resumes else 0.0
        self._begin: float | None = clock()

    def told(self, done: float) -> None:
        """Take note of what is done; typer.Abort when somebody does not want to go on."""
        if self._before is None:
            self._before, self._begin = done, self._clock()
        if self._begin is None or not done > self._before:
            return
        elapsed = self._clock() - self._begin
        if elapsed < LOOKED:
            return
        self._begin = None
        left = elapsed * (self._total - done) / (done - self._before)
        size = f": {self._size(done / self._total)}" if self._size else ""
        if left >= LONG and not self._ask(f"About {duration_words(left)} to go at this pace{size}."):
            raise typer.Abort


def asked(sentence: str) -> bool:
    """Announce on standard error; where input and output are terminals, wait for the answer."""
    if sys.stdin.isatty() and sys.stdout.isatty():
        return typer.confirm(f"{sentence} Go on?", default=True, err=True)
    return told(sentence)


def told(sentence: str) -> bool:
    """Announce on standard error, and go on."""
    print("rthm:", sentence, file=sys.stderr, flush=True)
    return True


def size_in(folder: Path, what: str) -> Callable[[float], str]:
    """Words on the size of some work: `what` it is, and how much its folder will hold at this pace."""

    def words(share: float) -> str:
        so_far = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
        return f"{what}, {bytes_words(so_far / share)} in {folder} at the end"

    return words


def bytes_words(count: float) -> str:
    """Bytes with the digits that an estimate deserves.

    Examples
    --------
    >>> bytes_words(3.21e9), bytes_words(0)
    ('3.21 GB', '0 B')
    """
    power = min(max(0, int(math.log10(max(count, 1.0))) // 3), len(UNITS) - 1)
    return f"{count / 1000.0**power:.3g} {UNITS[power]}"


def duration_words(seconds: float) -> str:
    """A time with the digits that an estimate deserves.

    Examples
    --------
    >>> duration_words(9000.0), duration_words(900_000.0)
    ('2.5 hours', '10 days')
    """
    hours = seconds / 3600.0
    return f"{hours:.2g} hours" if hours < 48.0 else f"{float(f'{hours / 24.0:.2g}'):g} days"
