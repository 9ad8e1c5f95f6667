"""Every crossing of a rate through zero, not the first that a coarse scan meets.

The growth rates of a loop, sorted, are continuous functions of a parameter with kinks where two eigenvalues
change places. A scan starts with steps that resolve the phases in the loop. An interval is then halved for as
long as one of the rates could reach zero within it at the pace at which it changes there, or in one of the
intervals beside it: a dip between two points that look alike shows in the slopes around it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats

Rates = Callable[[Floats], Floats]
"""Growth rates (X, R), sorted from the largest, at parameters (X,)."""

PACE = 3.0
"""How many times its visible change a rate is trusted to change within an interval."""

FINEST = 2.0**-10
"""Dips are sought down to this part of the widest first step."""

MOST_POINTS = 20_000


class Crossing(NamedTuple):
    """Where stability is lost, or won back, as the parameter grows."""

    value: float
    lost: bool


class Scan(NamedTuple):
    """Where the largest rate crosses zero in [begin, end], and its sign at `begin`."""

    crossings: tuple[Crossing, ...]
    stable_at_begin: bool
    begin: float
    end: float

    def stable_at(self, value: float) -> bool:
        """Whether the loop is stable at a value of the range."""
        return self.stable_at_begin ^ (sum(one.value < value for one in self.crossings) % 2 == 1)

    def first_lost(self, start: float) -> float | None:
        """Where stability is first lost from `start` on; `start` if it is not there, None if it stays."""
        if not self.stable_at(start):
            return start
        return next((one.value for one in self.crossings if one.lost and one.value >= start), None)

    def around(self, value: float) -> tuple[float | None, float | None]:
        """Crossings next below and next above a value."""
        below = [one.value for one in self.crossings if one.value <= value]
        above = [one.value for one in self.crossings if one.value > value]
        return (below[-1] if below else None), (above[0] if above else None)


def scan(rates: Rates, points: Floats, resolution: float, finest: float | None = None) -> Scan:
    """Find every crossing between the first and the last of the ascending `points`, to `resolution`; dips
    between points nearer than `finest` (a thousandth of the widest step when absent) are not sought.
    """
    x = np.asarray(points, dtype=float)
    finest = max(resolution, FINEST * np.diff(x).max() if finest is None else finest)
    x, g = refined(rates, x, rates(x), finest)
    sides = g[:, 0] > 0.0
    at = np.flatnonzero(sides[1:] != sides[:-1])
    low, high, lost = x[at], x[at + 1], sides[at + 1]
    while at.size and np.any(high - low > resolution):
        middle = 0.5 * (low + high)
        beyond = (rates(middle)[:, 0] > 0.0) == lost
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    found = tuple(
        Crossing(float(value), bool(side)) for value, side in zip(0.5 * (low + high), lost, strict=True)
    )
    return Scan(found, not bool(sides[0]), float(x[0]), float(x[-1]))


def refined(rates: Rates, x: Floats, g: Floats, finest: float) -> tuple[Floats, Floats]:
    """Points and rates after halving every interval in which a crossing could hide."""
    while x.size < MOST_POINTS:
        split = np.flatnonzero(_suspect(x, g) & (np.diff(x) > finest))
        if split.size == 0:
            break
        middle = 0.5 * (x[split] + x[split + 1])
        x, g = np.insert(x, split + 1, middle), np.insert(g, split + 1, rates(middle), axis=0)
    return x, g


def _suspect(x: Floats, g: Floats) -> np.ndarray:
    """Which intervals could hide a pair of crossings."""
    width = np.diff(x)[:, None]
    slope = np.abs(np.diff(g, axis=0)) / width
    beside = np.maximum(np.vstack([slope[:1], slope[:-1]]), np.vstack([slope[1:], slope[-1:]]))
    reach = PACE * width * np.maximum(slope, beside)
    near = np.minimum(np.abs(g[1:]), np.abs(g[:-1])) <= reach
    above, below = (g[1:, 0] > 0.0) & (g[:-1, 0] > 0.0), (g[1:, 0] <= 0.0) & (g[:-1, 0] <= 0.0)
    return np.asarray((above & near[:, 0]) | (below & near.any(axis=1)))
