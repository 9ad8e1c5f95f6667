"""Which tick of its receiver a use of a link belongs to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rthm_core.compiled import Integers

LONGEST_STALL = 200
"""Ticks over which a receiver that stood still is followed while it catches up."""


def tick_of_each(uses: Integers, ticks: Integers, period: int) -> Integers:
    """Number of the tick at which each of the `uses` took place; -1: of none of them.

    A use follows its tick, and a tick has one use. A receiver that stood still does many ticks at once when
    it catches up: of several uses after one tick, the last belongs to it and the others to those before it
    that have none. A use for which there is no such tick is a repetition.

    Parameters
    ----------
    uses, ticks : arrays
        Ascending instants, ns.
    period : int
        Time between ticks, ns; a use that comes later after the last known tick belongs to an unknown one.
    """
    newest = np.searchsorted(ticks, uses, side="right") - 1
    if not ticks.size:
        return newest
    known = np.flatnonzero((newest >= 0) & (uses - ticks[np.maximum(newest, 0)] < period))
    owner = np.full(ticks.size, -1, dtype=np.int64)
    owner[newest[known]] = known
    for use in known[owner[newest[known]] != known]:
        _make_room(owner, int(newest[use]), int(use))
    owned = np.flatnonzero(owner >= 0)
    numbers = np.full(uses.size, -1, dtype=np.int64)
    numbers[owner[owned]] = owned
    return numbers


def _make_room(owner: Integers, tick: int, use: int) -> None:
    """Move uses before `tick` down to the nearest tick without one; `use` then comes before the last."""
    first = max(tick - LONGEST_STALL, 0)
    free = np.flatnonzero(owner[first:tick] < 0)
    if free.size:
        place = first + int(free[-1])
        owner[place : tick - 1] = owner[place + 1 : tick].copy()
        owner[tick - 1] = use
