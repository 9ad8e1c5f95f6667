"""Loads on the dofs, on the grid of a replay: what is known, and what effects add."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.replay.between import Between
from rthm_core.loads import sinusoid
from rthm_core.physical.laws import plant_laws
from rthm_core.physical.model import excitations

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_analysis.diagnosis.replay.grid import Grid
    from rthm_analysis.diagnosis.replay.mechanics import Mechanics
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


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
        return straight(grid, time, load)
    from scipy.interpolate import CubicSpline

    smooth = np.zeros((*points.shape, load.shape[1]))
    for one, (begin, end) in zip(evidence.recordings, evidence.spans, strict=True):
        there = points[:, 0] >= begin
        smooth[there] = CubicSpline(time[one], load[one])(np.minimum(points[there], end))
    return smooth


def straight(grid: Grid, time: Floats, load: Floats) -> Floats:
    """Loads (s, n), known at some times (s,), along straight lines at the points of a grid: (g, 3, n)."""
    points = np.minimum(grid.points, time[-1])
    return np.stack([np.interp(points, time, column) for column in load.T], axis=2)


def on_columns(mechanics: Mechanics, known: Floats, *beside: Floats | None) -> Floats:
    """Known loads (g, 3, n) and others beside them on the columns of some mechanics: added to them, or apart,
    where a law depends on the known ones alone.
    """
    others = [one for one in beside if one is not None]
    if mechanics.loads > known.shape[2]:
        return np.concatenate([known, sum(others, np.zeros_like(known))], axis=2)
    return np.asarray(sum(others, known))


def hidden_loads(spec: Spec, points: Grid) -> Floats | None:
    """Loads of effects that depend on time alone: (g, 3, n); None without any."""
    assert spec.plant is not None
    loads = None
    for law, p, place in plant_laws(spec):
        for dof, shape in excitations(law, p, place):
            if loads is None:
                loads = np.zeros((points.time_ns.size, 3, len(spec.plant.dofs)))
            loads[:, :, dof] += sinusoid(*shape).force(points.points)
    return loads
