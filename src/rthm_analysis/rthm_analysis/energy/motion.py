"""Motion of the plant from its samples: what a driver leaves out is estimated."""

from __future__ import annotations

import numpy as np

from rthm_core.clock import NS
from rthm_core.compiled import Floats, Integers
from rthm_core.spec import Spec
from rthm_core.substructure import free_dynamics, substructure

WINDOW_PHASE = 0.1
"""Half width, in radians of the plant's fastest motion, of the window in which a velocity is estimated."""

LARGEST_HALF_WIDTH = 10
"""Largest half width in samples."""


def window(spec: Spec, period: float) -> int:
    """Samples on each side from which a missing velocity is estimated.

    Parameters
    ----------
    spec : Spec
        Of which the plant says how fast it can move.
    period : float
        Sampling period, s.
    """
    plant = substructure(spec.plant)
    dynamics, _ = free_dynamics(plant.mass, plant.damping, plant.stiffness)
    step = float(np.abs(np.linalg.eigvals(dynamics)).max()) * period
    return int(np.clip(WINDOW_PHASE / step, 1, LARGEST_HALF_WIDTH)) if step > 0.0 else LARGEST_HALF_WIDTH


def motion_at(stamps_ns: Integers, motion: Floats, at_ns: Integers) -> Floats:
    """Motion [x (k), v (k)] at the instants `at_ns`: the sample, or what is between two where it is missing.

    Parameters
    ----------
    stamps_ns : (n,) array
        Ascending, n >= 1.
    motion : (n, 2 k) array
        m and m/s.
    at_ns : (a,) array
        NaN results before the first sample; after the last one its motion holds.

    Returns
    -------
    (a, 2 k) array
        On the cubic through position and velocity of both neighbours.
    """
    row = np.searchsorted(stamps_ns, at_ns, side="right") - 1
    here, after = np.maximum(row, 0), np.minimum(np.maximum(row, 0) + 1, stamps_ns.size - 1)
    found = motion[here]
    between = (stamps_ns[here] < at_ns) & (after > here)
    if between.any():
        found[between] = _cubic(stamps_ns, motion, here[between], after[between], at_ns[between])
    found[row < 0] = np.nan
    return found


def _cubic(stamps_ns: Integers, motion: Floats, here: Integers, after: Integers, at_ns: Integers) -> Floats:
    k = motion.shape[1] // 2
    h = ((stamps_ns[after] - stamps_ns[here]) / NS)[:, None]
    r = ((at_ns - stamps_ns[here]) / NS)[:, None] / h
    x0, v0, x1, v1 = motion[here, :k], h * motion[here, k:], motion[after, :k], h * motion[after, k:]
    bend, twist = 3.0 * (x1 - x0) - 2.0 * v0 - v1, v0 + v1 - 2.0 * (x1 - x0)
    return np.hstack([x0 + r * (v0 + r * (bend + r * twist)), (v0 + r * (2.0 * bend + r * 3.0 * twist)) / h])


def completed_velocity(stamps_ns: Integers, position: Floats, velocity: Floats, width: int) -> Floats:
    """Velocity (n, k); where it was not measured, the slope of a local parabola through the positions."""
    if np.isfinite(velocity).all() or stamps_ns.size < 2:
        return np.nan_to_num(velocity, nan=0.0)
    return np.where(np.isfinite(velocity), velocity, _slopes(stamps_ns, position, width))


def _slopes(stamps_ns: Integers, position: Floats, width: int) -> Floats:
    """Slope at each sample of the parabola through it and its neighbours, least squares."""
    n = stamps_ns.size
    size = min(2 * width + 1, n)
    first = np.clip(np.arange(n) - width, 0, n - size)
    window = first[:, None] + np.arange(size)
    t = (stamps_ns[window] - stamps_ns[:, None]) / NS
    powers = np.stack([np.ones_like(t), t, t * t][: min(3, size)], axis=2)
    scale = np.abs(t).max(axis=1)[:, None] ** np.arange(powers.shape[2])
    fit = np.linalg.pinv(powers / scale[:, None, :])
    return np.asarray(np.einsum("nw,nwk->nk", fit[:, 1], position[window]) / scale[:, 1:2])
