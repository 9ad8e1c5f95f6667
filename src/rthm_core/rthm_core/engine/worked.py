"""Work over a step as products of what it begins with, compiled; the loops over a tuple are written out."""

from __future__ import annotations

from rthm_core.compiled import inlined
from rthm_core.simd import everywhere, numbers


@inlined
def worked(tables, k, z):  # type: ignore[no-untyped-def]
    """Work (8,), a SIMD value, over a step from `z` on.

    Table `k` of `tables` (K, d (d + 1) / 2, 8) has the coefficients of the products of every two elements.
    """
    total, pair = everywhere(0.0), 0
    for i in range(len(z)):
        one = other = everywhere(0.0)  # side by side: a sum waits for the one before
        for j in range(i, len(z) - 1, 2):
            one += numbers(tables, (k, pair)) * z[j]
            other += numbers(tables, (k, pair + 1)) * z[j + 1]
            pair += 2
        if (len(z) - i) % 2:
            one += numbers(tables, (k, pair)) * z[len(z) - 1]
            pair += 1
        total += (one + other) * z[i]
    return total


@inlined
def energy(form, z):  # type: ignore[no-untyped-def]
    """Sum over every two elements of `z` of ``form[pair] z_i z_j``."""
    total, pair = 0.0, 0
    for i in range(len(z)):
        part = 0.0
        for j in range(i, len(z)):
            part += form[pair] * z[j]
            pair += 1
        total += part * z[i]
    return total
