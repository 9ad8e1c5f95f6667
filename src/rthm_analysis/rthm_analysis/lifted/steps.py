"""Exact steps of a linear system over many intervals at once."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats

ORDER = 13
"""Terms of the Taylor series; with a norm below one half its remainder is below 1e-15."""


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
    norm = np.abs(joint).sum(axis=0).max(initial=0.0) * np.abs(intervals).max(initial=0.0)
    halvings = max(0, int(np.ceil(np.log2(2.0 * norm)))) if norm > 0.0 else 0
    generator = joint * (intervals / 2.0**halvings)[:, None, None]
    # Squaring exp(x) - 1 instead of exp(x) keeps the digits of small steps.
    rest = generator / ORDER
    for k in range(ORDER - 1, 0, -1):
        rest = (generator + generator @ rest) / k
    for _ in range(halvings):
        rest = 2.0 * rest + rest @ rest
    return (rest + np.eye(n + q))[:, :n]
