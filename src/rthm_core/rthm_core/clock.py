"""Time is integer nanoseconds. Tick k of a clock is ``k * period``, never a sum of periods: no drift.

The tick at an instant belongs to that instant::

    tick       0         1         2         3
               |---------|---------|---------|---->  ns
    index_at   0000000000111111111122222222223333
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

from rthm_core.errors import InputError, refusal

NS = 1_000_000_000
"""Nanoseconds in a second."""

EARLIEST_YEAR = 2000
"""Stamps before it are simulated time, which begins in 1970."""

LONGEST = 2**63 - 1
"""Latest instant that a stored stamp can hold, in ns."""


class Rank(IntEnum):
    """Order of what happens at one instant (smaller first)."""

    DELAY = 0
    """A delay that is due is over: the sample is at its receiver."""
    SAMPLE = 1
    """The data acquisition samples plant and actuator (Td1)."""
    NUMERICAL = 2
    """The numerical substructure latches z1 and gives F_d (Td2)."""
    CONTROL = 3
    """The controller gives u_d (Td3)."""


def to_ns(seconds: float) -> int:
    """Nearest integer ns (never truncated).

    Raises
    ------
    InputError
        If `seconds` is not finite or lies beyond what a stamp can hold.
    """
    if not math.isfinite(seconds) or abs(seconds) * NS > LONGEST:
        raise refusal("a time", seconds, "a finite number of seconds below 292 years")
    return round(seconds * NS)


@dataclass(frozen=True)
class Clock:
    """Ticks at ``k * period_ns`` for k = 0, 1, 2, ...; the first tick is the start of the test."""

    period_ns: int

    def __post_init__(self) -> None:
        if self.period_ns <= 0:
            raise InputError(
                f"a clock's period is {self.period_ns} ns, but must be at least 1 ns; correct it."
            )

    def tick(self, k: int) -> int:
        """Instant of tick `k` in ns after the start."""
        return k * self.period_ns

    def index_at(self, ns: int) -> int:
        """Newest k with ``tick(k) <= ns``; -1 before the start."""
        return max(ns // self.period_ns, -1)
