"""Moduli of the eigenvalues of a small real matrix, for compiled code.

Gaussian reduction to Hessenberg form with pivoting, then the double-shift QR iteration (Francis), as in the
classical ``elmhes`` and ``hqr``. A small matrix takes microseconds, and nothing is called from outside.
"""

from __future__ import annotations

import math

import numpy as np

from rthm_analysis.lifted.compiled import compiled, inlined

EPSILON = 2.0**-52
MOST_ITERATIONS = 90


@inlined
def _swap(a, m, i):  # type: ignore[no-untyped-def]
    """Exchange rows and columns `m` and `i`."""
    for j in range(a.shape[0]):
        a[i, j], a[m, j] = a[m, j], a[i, j]
    for j in range(a.shape[0]):
        a[j, i], a[j, m] = a[j, m], a[j, i]


@inlined
def _hessenberg(a):  # type: ignore[no-untyped-def]
    """Reduce a matrix (n, n) in place by elimination with pivoting."""
    n = a.shape[0]
    for m in range(1, n - 1):
        pivot = m
        for j in range(m + 1, n):
            if abs(a[j, m - 1]) > abs(a[pivot, m - 1]):
                pivot = j
        if a[pivot, m - 1] == 0.0:
            continue
        if pivot != m:
            _swap(a, m, pivot)
        for i in range(m + 1, n):
            factor = a[i, m - 1] / a[m, m - 1]
            if factor != 0.0:
                for j in range(m - 1, n):
                    a[i, j] -= factor * a[m, j]
                for j in range(n):
                    a[j, m] += factor * a[j, i]
            a[i, m - 1] = 0.0


@inlined
def _small(a, low, high, norm):  # type: ignore[no-untyped-def]
    """First row of the block that ends at `high` and no longer falls apart."""
    for k in range(high, low, -1):
        scale = abs(a[k - 1, k - 1]) + abs(a[k, k])
        if scale == 0.0:
            scale = norm
        if abs(a[k, k - 1]) <= EPSILON * scale:
            a[k, k - 1] = 0.0
            return k
    return low


@inlined
def _pair(a, high, out):  # type: ignore[no-untyped-def]
    """Write the moduli of the eigenvalues of the two by two block that ends at `high`."""
    p, q = a[high - 1, high - 1], a[high, high]
    product = a[high, high - 1] * a[high - 1, high]
    half, middle = 0.5 * (p - q), 0.5 * (p + q)
    under = half * half + product
    if under >= 0.0:
        larger = abs(middle) + math.sqrt(under)
        out[high] = larger
        out[high - 1] = abs(middle * middle - under) / larger if larger > 0.0 else 0.0
    else:
        out[high] = out[high - 1] = math.sqrt(middle * middle - under)


@inlined
def _reflect(a, k, first, high, p, q, r, low):  # type: ignore[no-untyped-def]
    """Apply the reflection that takes (p, q, r) to its first axis to rows and columns k, k+1, k+2."""
    size = math.sqrt(p * p + q * q + r * r)
    if size == 0.0:
        return
    s = -size if p < 0.0 else size
    if k > first:
        a[k, k - 1] = -s
    elif first > low:
        a[k, k - 1] = -a[k, k - 1]
    x, y, z = (p + s) / s, q / s, r / s
    q, r = q / (p + s), r / (p + s)
    three = k < high - 1
    for j in range(k, high + 1):
        total = a[k, j] + q * a[k + 1, j]
        if three:
            total += r * a[k + 2, j]
            a[k + 2, j] -= total * z
        a[k + 1, j] -= total * y
        a[k, j] -= total * x
    for i in range(low, min(high, k + 3) + 1):
        total = x * a[i, k] + y * a[i, k + 1]
        if three:
            total += z * a[i, k + 2]
            a[i, k + 2] -= total * r
        a[i, k + 1] -= total * q
        a[i, k] -= total


@inlined
def _sweep(a, low, high, iteration):  # type: ignore[no-untyped-def]
    """One double-shift step on the block [low, high]."""
    x, y = a[high, high], a[high - 1, high - 1]
    w = a[high, high - 1] * a[high - 1, high]
    if iteration % 10 == 9:
        shift = abs(a[high, high - 1]) + abs(a[high - 1, high - 2])
        x = y = a[high, high] + 0.75 * shift
        w = -0.4375 * shift * shift
    m, p, q, r = high - 2, 0.0, 0.0, 0.0
    while True:
        z = a[m, m]
        one, two = x - z, y - z
        p = (one * two - w) / a[m + 1, m] + a[m, m + 1]
        q = a[m + 1, m + 1] - z - one - two
        r = a[m + 2, m + 1]
        scale = abs(p) + abs(q) + abs(r)
        p, q, r = p / scale, q / scale, r / scale
        if m == low:
            break
        beside = abs(a[m, m - 1]) * (abs(q) + abs(r))
        if beside <= EPSILON * abs(p) * (abs(a[m - 1, m - 1]) + abs(z) + abs(a[m + 1, m + 1])):
            break
        m -= 1
    for i in range(m + 2, high + 1):
        a[i, i - 2] = 0.0
        if i > m + 2:
            a[i, i - 3] = 0.0
    for k in range(m, high):
        if k > m:
            p, q = a[k, k - 1], a[k + 1, k - 1]
            r = a[k + 2, k - 1] if k < high - 1 else 0.0
        _reflect(a, k, m, high, p, q, r, low)


@compiled
def write_moduli(a: np.ndarray, out: np.ndarray) -> None:
    """Write the moduli (n,) of the eigenvalues of `a` (n, n), which is overwritten; nan where the iteration
    does not converge.
    """
    _hessenberg(a)
    norm = np.abs(a).max() if a.size else 0.0
    high, iteration = a.shape[0] - 1, 0
    while high >= 0:
        low = _small(a, 0, high, norm)
        if low == high:
            out[high] = abs(a[high, high])
            high, iteration = high - 1, 0
        elif low == high - 1:
            _pair(a, high, out)
            high, iteration = high - 2, 0
        elif iteration == MOST_ITERATIONS or not norm < np.inf:
            out[: high + 1] = np.nan
            return
        else:
            _sweep(a, low, high, iteration)
            iteration += 1
