"""Step matrices of a linear system for many lengths at once."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, inlined

_TERMS = 20
"""Terms of the series: exact to rounding where ``spectral radius * length <= 1/2``."""

_NOTHING = 1e-17
"""What a term may be of the sum without changing it."""


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
    a = np.ascontiguousarray(a, dtype=float)
    out = np.empty((t.size, *a.shape))
    _exponentials(a, rate_bound(a), t, np.empty((SCRATCH, *a.shape)), out)
    return out


def rate_bound(a: Floats) -> float:
    """What no eigenvalue of `a` (n, n) exceeds, 1/s.

    From the square: positions and velocities, whose units differ, change places in it.
    """
    return float(np.sqrt(np.abs(a @ a).sum(axis=1).max(initial=0.0)))


SCRATCH = 3
"""Matrices that `put_exponential` needs as scratch."""


@inlined
def put_product(a, b, out):  # type: ignore[no-untyped-def]
    """Matrix product, and whether there is anything in it; what is zero in `a`, as much is in a system with
    held inputs, costs nothing.
    """
    anything = False
    for i in range(a.shape[0]):
        for j in range(b.shape[1]):
            out[i, j] = 0.0
        for k in range(a.shape[1]):
            factor = a[i, k]
            if factor != 0.0:
                anything = True
                for j in range(b.shape[1]):
                    out[i, j] += factor * b[k, j]
    return anything


@called
def put_exponential(a, bound, t, scratch, out):  # type: ignore[no-untyped-def]
    """Matrix ``exp(a t)`` with the `rate_bound` of `a`."""
    x, term, fresh, n = scratch[0], scratch[1], scratch[2], a.shape[0]
    halvings = 0
    while bound * t > 0.5:
        t *= 0.5
        halvings += 1
    for i in range(n):
        for j in range(n):
            x[i, j] = term[i, j] = out[i, j] = a[i, j] * t
    for k in range(2, _TERMS + 1):
        put_product(term, x, fresh)
        settled = k > n  # each element that the series ever reaches has been
        for i in range(n):
            for j in range(n):
                term[i, j] = fresh[i, j] / k
                out[i, j] += term[i, j]
                settled = settled and abs(term[i, j]) <= _NOTHING * abs(out[i, j])
        if settled:
            break
    for _ in range(halvings):
        put_product(out, out, fresh)
        for i in range(n):
            for j in range(n):
                out[i, j] = 2.0 * out[i, j] + fresh[i, j]
    for i in range(n):
        out[i, i] += 1.0


@compiled_in_place
def _exponentials(a: Floats, bound: float, times: Floats, scratch: Floats, out: Floats) -> None:
    for k in range(times.size):
        put_exponential(a, bound, times[k], scratch, out[k])
