"""When something comes in: the time grid of a replay, and what is known on it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers

SHARES = np.array([0.0, 0.5, 1.0])
"""Where in an interval of the grid the inputs are given."""


@dataclass(frozen=True)
class Grid:
    """Instants at which something comes in: the steps of a replay end there.

    Attributes
    ----------
    time_ns : (g,) array
        Ascending, ns since the start of the test, from 0.
    """

    time_ns: Integers

    @cached_property
    def time(self) -> Floats:
        """The instants in s."""
        return self.time_ns / NS

    @cached_property
    def points(self) -> Floats:
        """Start, middle and end of each interval, in s: (g, 3)."""
        length = np.append(np.diff(self.time), 0.0)
        return np.asarray(self.time[:, None] + SHARES * length[:, None])

    @cached_property
    def points_before_jumps(self) -> Floats:
        """`points` whose ends are a hair before the instants at which the next interval starts: (g, 3)."""
        points = self.points.copy()
        points[:-1, 2] = np.nextafter(self.time[1:], 0.0)
        return points


def grid(instants_ns: Integers, end_ns: int, longest_ns: int) -> Grid:
    """Grid of some instants from 0 to `end_ns`, with no interval longer than `longest_ns`."""
    inside = instants_ns[(instants_ns > 0) & (instants_ns < end_ns)]
    instants = np.sort(np.concatenate([[0], inside, [end_ns]]), kind="stable")  # quick for rows in order
    instants = instants[np.diff(instants, prepend=-1) > 0]
    pieces = np.maximum(1, -(-np.diff(instants) // longest_ns))
    if np.any(pieces > 1):
        starts = np.repeat(instants[:-1], pieces)
        inner = np.arange(starts.size) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        share = np.repeat(np.diff(instants) // pieces, pieces)
        instants = np.append(starts + inner * share, instants[-1])
    return Grid(instants)
