"""When something comes in: the time grid of a replay, and what is known on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers

SHARES = np.array([0.0, 0.5, 1.0])
"""Where in an interval of the grid the inputs are given."""


@dataclass(frozen=True)
class Grid:
    """Instants at which samples were taken or commands fell due.

    Attributes
    ----------
    time_ns : (g,) array
        Ascending, ns since the start of the test, from 0.
    sample : (s,) array
        Index of the instant of each sample of ``plant/state``.
    """

    time_ns: Integers
    sample: Integers

    @property
    def time(self) -> Floats:
        """The instants in s."""
        return self.time_ns / NS

    @property
    def points(self) -> Floats:
        """Start, middle and end of each interval, in s: (g, 3)."""
        length = np.append(np.diff(self.time), 0.0)
        return np.asarray(self.time[:, None] + SHARES * length[:, None])


def grid(stamps_ns: Integers, due_ns: Integers, longest_ns: int) -> Grid:
    """Grid of samples and instants at which inputs change, with no interval longer than `longest_ns`."""
    inside = due_ns[(due_ns > 0) & (due_ns < stamps_ns[-1])]
    instants = np.unique(np.concatenate([[0], stamps_ns, inside]))
    pieces = np.maximum(1, -(-np.diff(instants) // longest_ns))
    if np.any(pieces > 1):
        starts = np.repeat(instants[:-1], pieces)
        inner = np.arange(starts.size) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        share = np.repeat(np.diff(instants) // pieces, pieces)
        instants = np.append(starts + inner * share, instants[-1])
    return Grid(instants, np.searchsorted(instants, stamps_ns))
