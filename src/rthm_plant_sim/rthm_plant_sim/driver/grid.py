"""Samples on a grid from readings that are not quite.

A reading belongs to its tick when it is made within a tenth of a period after it. When a host is held up it
is made later, and ticks have gone by without one. A sample of such a tick lies on the straight line between
the readings before and after it, so that nothing is stamped with a time at which it was not true. Over a
longer pause nothing is known, and its samples are missing.
"""

from __future__ import annotations

import numpy as np

from rthm_core.clock import NS
from rthm_core.slew import Floats

ON_TIME = 0.1
"""How late a reading may be to belong to its tick, share of the period."""
LONGEST = NS // 10
"""Longest pause between readings over which samples are made, ns.

Linux takes 50 ms of each second from threads with real-time priority that leave nothing to others. A test
whose `stale` is shorter has ended before.
"""


class Grid:
    """Makes the samples of all ticks.

    Parameters
    ----------
    period
        Distance of the ticks, ns.

    Attributes
    ----------
    between, missing
        Samples that lie between two readings, and ticks without any.
    """

    def __init__(self, period: int) -> None:
        self._period, self._late = period, ON_TIME * period
        self._tick: int | None = None
        self._made = 0
        self._values: Floats = np.empty(0)
        self.between = self.missing = 0

    def samples(self, tick: int, made: int, values: Floats) -> list[tuple[int, Floats]]:
        """Stamps and values of the ticks up to `tick`, by a reading that was made at `made` >= `tick`, ns."""
        found = []
        if self._tick is None or made - self._made > LONGEST:
            self.missing += 0 if self._tick is None else (tick - self._tick) // self._period - 1
        else:
            for at in range(self._tick + self._period, tick, self._period):
                found.append((at, self._line(at, made, values)))
        on_time = made - tick <= self._late or self._tick is None
        found.append(
            (tick, values if on_time or made - self._made > LONGEST else self._line(tick, made, values))
        )
        self._tick, self._made, self._values = tick, made, values
        return found

    def _line(self, at: int, made: int, values: Floats) -> Floats:
        """Value at an instant between the last reading and this one."""
        self.between += 1
        share = (at - self._made) / max(made - self._made, 1)
        return np.asarray(self._values + min(max(share, 0.0), 1.0) * (values - self._values))
