"""Where stability is first lost: what is told of every test, without the rest of a whole search."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.lifted.cycle import Cycle
from rthm_analysis.lifted.matrices import LinearLoop
from rthm_analysis.stability.limits import (
    FINEST_DELAY,
    FINEST_FACTOR,
    LARGEST_FACTOR,
    delay_points,
    scale_points,
)
from rthm_analysis.stability.rates import of_delay, of_scale_at_each
from rthm_analysis.stability.search import FINEST, Rates, refined
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_core.spec import Spec

FIRST_POINTS = 25
"""First points of a search; where an edge could hide between them it looks closer."""

POINTS_TOGETHER = 8
"""Points that are looked at together."""


def scale_edge(spec: Spec, loop: LinearLoop, cycle: Cycle) -> float | None:
    """Factor on all periods and delays at which stability is first lost; 0: there is none; None: nowhere."""
    points = scale_points(spec, loop, LARGEST_FACTOR, FIRST_POINTS)
    found = first_lost(of_scale_at_each(loop, cycle), points, FINEST_FACTOR)
    return 0.0 if found == points[0] else found


def delay_edge(spec: Spec, loop: LinearLoop, name: str, upto: float) -> float | None:
    """Value of one delay alone, s, at which stability is first lost, up to `upto` times its own; 0: there is
    none without it; None: nowhere.
    """
    points = delay_points(spec, loop, name, upto, FIRST_POINTS)
    return first_lost(of_delay(spec, loop, name), points, FINEST_DELAY)


def first_lost(rates: Rates, points: Floats, resolution: float) -> float | None:
    """Where the largest rate first becomes positive, to `resolution`; the first point if it is so there.

    The same search as `scan`, but what lies beyond the edge is not looked at.
    """
    finest = max(resolution, FINEST * np.diff(points).max())
    x, g = points[:0], rates(points[:0])
    for begin in range(0, points.size, POINTS_TOGETHER):
        ahead = points[begin : begin + POINTS_TOGETHER]
        x, g = refined(rates, np.append(x, ahead), np.vstack([g, rates(ahead)]), finest)
        lost = np.flatnonzero(g[:, 0] > 0.0)
        is_end = begin + POINTS_TOGETHER >= points.size
        if lost.size and (lost[0] < x.size - 1 or is_end):  # what follows an interval can split it
            at = int(lost[0])
            return (
                float(x[0])
                if at == 0
                else _narrowed(rates, x[at - 1 : at + 1], g[at - 1 : at + 1, 0], resolution)
            )
    return None


def _narrowed(rates: Rates, around: Floats, values: Floats, resolution: float) -> float:
    """Root between two points by false position; an end that stays counts half and so moves (Illinois)."""
    (low, high), (at_low, at_high), stayed = around, values, 0
    while high - low > resolution:
        guess = high - at_high * (high - low) / (at_high - at_low)
        guess = min(max(guess, low + 0.5 * resolution), high - 0.5 * resolution)
        value = float(rates(np.array([guess]))[0, 0])
        if value > 0.0:
            high, at_high = guess, value
            at_low *= 0.5 if stayed < 0 else 1.0
            stayed = -1
        else:
            low, at_low = guess, value
            at_high *= 0.5 if stayed > 0 else 1.0
            stayed = 1
    return float(0.5 * (low + high))
