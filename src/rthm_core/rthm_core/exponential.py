"""Step matrices of a linear system for many lengths at once."""

from __future__ import annotations

import math

import numpy as np

from rthm_core.compiled import Floats, Integers

_TERMS = 20
"""Terms of the series: exact to rounding where ``spectral radius * length <= 1/2``."""


def exponentials(a: Floats, lengths_ns: Integers | Floats) -> Floats:
    """Step matrices ``exp(a t)`` of the system ``dy/dt = a y``.

    Scaling and squaring of the Taylor series, on ``exp(a t) - 1`` so that slow modes stay exact to rounding
    beside fast ones.

    Parameters
    ----------
    a : (n, n) array
        Dynamics, 1/s.
    lengths_ns : (K,) array
        Lengths t in ns.

    Returns
    -------
    (K, n, n) array
    """
    t = np.asarray(lengths_ns, dtype=float) * 1e-9
    fastest = float(np.abs(np.linalg.eigvals(a)).max(initial=0.0)) * float(t.max(initial=0.0))
    halvings = max(0, math.ceil(math.log2(2.0 * fastest))) if fastest > 0.5 else 0
    x = (t * 0.5**halvings)[:, None, None] * a
    grown = x / _TERMS
    for k in range(_TERMS - 1, 0, -1):
        grown = (x + x @ grown) / k
    for _ in range(halvings):
        grown = 2.0 * grown + grown @ grown
    return np.asarray(grown + np.eye(a.shape[0]))
