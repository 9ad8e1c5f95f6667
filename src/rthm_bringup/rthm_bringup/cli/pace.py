"""How long work will take, told before it has taken hours, and asked about where somebody can answer."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import typer

LOOKED = 10.0
"""Time after which the pace of some work is known, s."""

LONG = 3600.0
"""Time from which on work is announced, s."""


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
    """

    def __init__(
        self,
        total: float,
        ask: Callable[[str], bool] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._total, self._ask, self._clock = total, ask or asked, clock
        self._begin: float | None = clock()

    def told(self, done: float) -> None:
        """Take note of what is done; typer.Abort when somebody does not want to go on."""
        if self._begin is None or not done > 0.0:
            return
        elapsed = self._clock() - self._begin
        if elapsed < LOOKED:
            return
        self._begin = None
        left = elapsed * (self._total / done - 1.0)
        if left >= LONG and not self._ask(f"About {duration_words(left)} to go at this pace."):
            raise typer.Abort


def asked(sentence: str) -> bool:
    """Tell on standard error; where input and output are terminals, wait for the answer."""
    if sys.stdin.isatty() and sys.stdout.isatty():
        return typer.confirm(f"{sentence} Go on?", default=True, err=True)
    print("rthm:", sentence, file=sys.stderr, flush=True)
    return True


def duration_words(seconds: float) -> str:
    """A time with the digits that an estimate deserves.

    Examples
    --------
    >>> duration_words(9000.0), duration_words(900_000.0)
    ('2.5 hours', '10 days')
    """
    hours = seconds / 3600.0
    return f"{hours:.2g} hours" if hours < 48.0 else f"{float(f'{hours / 24.0:.2g}'):g} days"
