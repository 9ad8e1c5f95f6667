"""Samples on a grid from readings that are not quite.

A reading belongs to its tick when it is made within a tenth of a period after it. When a host stalls it is
made later, and ticks have gone by without one. A sample of such a tick lies on the straight line between
the readings before and after it, so that nothing is stamped with a time at which it was not true. Over a
longer pause nothing is known, and its samples are missing.
"""

from __future__ import annotations

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.slew import Floats
from rthm_core.spec import LimitsSpec

ON_TIME = 0.1
"""How late a reading may be to belong to its tick, share of the period."""
MOST_AT_ONCE = 500
"""Most samples that are made at once: more would not be kept for a slow receiver."""


def longest_pause(limits: LimitsSpec, period: int) -> int:
    """Longest pause between readings over which samples are made, ns.

    The limit `stale` ends a test that has a longer one.

    Parameters
    ----------
    limits
        Of a real machine.
    period
        Distance of the ticks, ns.
    """
    return min(to_ns(limits.stale or 0.0), MOST_AT_ONCE * period)


class Grid:
    """Makes the samples of all ticks.

    Parameters
    ----------
    period
        Distance of the ticks, ns.
    longest
        Longest pause between readings over which samples are made, ns.

    Attributes
    ----------
    between, missing
        Samples that lie between two readings, and ticks without any.
    """

    def __init__(self, period: int, longest: int) -> None:
        self._period, self._longest, self._late = period, longest, ON_TIME * period
        self._tick: int | None = None
        self._made = 0
        self._values: Floats = np.empty(0)
        self.between = self.missing = 0

    def samples(self, tick: int, made: int, values: Floats) -> list[tuple[int, Floats]]:
        """Stamps and values of the ticks up to `tick`, by a reading that was made at `made` >= `tick`, ns."""
        found = []
        unknown = self._tick is None or made - self._made > self._longest
        if self._tick is not None and unknown:
            self.missing += (tick - self._tick) // self._period - 1
        elif self._tick is not None:
            for at in range(self._tick + self._period, tick, self._period):
                found.append((at, self._line(at, made, values)))
        as_read = unknown or made - tick <= self._late
        found.append((tick, values if as_read else self._line(tick, made, values)))
        self._tick, self._made, self._values = tick, made, values
        return found

    def _line(self, at: int, made: int, values: Floats) -> Floats:
        """Value at an instant between the last reading and this one."""
        self.between += 1
        share = (at - self._made) / max(made - self._made, 1)
        return np.asarray(self._values + min(max(share, 0.0), 1.0) * (values - self._values))
