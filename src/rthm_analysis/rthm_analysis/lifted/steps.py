"""Exact steps of a linear system with held inputs over many intervals at once."""

from __future__ import annotations

import numpy as np

from rthm_core.clock import NS
from rthm_core.compiled import Floats
from rthm_core.exponential import exponentials


def steps(a: Floats, b: Floats, intervals: Floats) -> Floats:
    """Matrices ``[Phi, Gamma]`` (D, n, n + q) of ``y(t + dt) = Phi y + Gamma u`` for a held input u.

    Parameters
    ----------
    a, b : (n, n), (n, q) arrays
        ``dy/dt = a y + b u``.
    intervals : (D,) array
        Lengths dt in s.
    """
    n, q = b.shape
    joint = np.zeros((n + q, n + q))
    joint[:n, :n], joint[:n, n:] = a, b
    return np.ascontiguousarray(exponentials(joint, intervals * NS)[:, :n])
