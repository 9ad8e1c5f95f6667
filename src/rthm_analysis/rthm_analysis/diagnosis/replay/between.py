"""What happened between two samples of a load: the recording does not say, and it matters more than noise."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_analysis.diagnosis.replay.grid import Grid
    from rthm_core.compiled import Floats


class Between(Enum):
    """How a load that is known by its samples goes between them; the values complete a sentence."""

    SMOOTH = "follows a smooth curve"
    LINEAR = "follows a straight line"
    HELD = "is held"


def load_on(grid: Grid, evidence: Evidence, between: Between) -> Floats:
    """Known loads at the start, the middle and the end of each interval of a grid: (g, 3, n), N."""
    time, load = evidence.time, evidence.load
    if not np.any(load):
        return np.zeros((grid.time_ns.size, 3, load.shape[1]))
    if between is Between.HELD:
        row = np.searchsorted(evidence.stamps_ns, grid.time_ns, side="right") - 1
        return np.repeat(load[row][:, None, :], 3, axis=1)
    points = np.minimum(grid.points, time[-1])
    if between is Between.LINEAR:
        return np.stack([np.interp(points, time, column) for column in load.T], axis=2)
    from scipy.interpolate import CubicSpline

    return np.asarray(CubicSpline(time, load)(points))


def ways(evidence: Evidence) -> tuple[Between, ...]:
    """What has to be tried: all where the loads of a plant are known by their samples alone."""
    sampled = evidence.driven_by == "force" and bool(np.any(evidence.load))
    return tuple(Between) if sampled else (Between.SMOOTH,)
