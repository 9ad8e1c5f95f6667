"""Work over a step as products of what it begins with, compiled.

Of a tuple `worked` writes the loops out. Where several steps begin with the same, or it is an array, products
come first and are weighed in one loop.
"""

from __future__ import annotations

from rthm_core.compiled import written_out
from rthm_core.simd import element, everywhere, numbers, put_element


@written_out
def worked(tables, k, z):  # type: ignore[no-untyped-def]
    """Work (8,), a SIMD value, over a step from `z` on.

    Table `k` of `tables` (K, d (d + 1) / 2, 8) has the coefficients of the products of every two elements.
    """
    total, pair = everywhere(0.0), 0
    for i in range(len(z)):
        part = everywhere(0.0)
        for j in range(i, len(z)):
            part += numbers(tables, (k, pair)) * z[j]
            pair += 1
        total += part * z[i]
    return total


@written_out
def put_products(z, out):  # type: ignore[no-untyped-def]
    """Products of every two elements of `z`, into `out`."""
    pair = 0
    for i in range(z.size):
        one = element(z, (i,))
        for j in range(i, z.size):
            put_element(out, (pair,), one * element(z, (j,)))
            pair += 1


@written_out
def weighed(tables, k, products):  # type: ignore[no-untyped-def]
    """Work (8,), a SIMD value, over a step that begins with what has such `products`."""
    one = other = third = last = everywhere(0.0)  # side by side: a sum waits for the one before
    size = products.size
    for pair in range(0, size - 3, 4):
        one += numbers(tables, (k, pair)) * element(products, (pair,))
        other += numbers(tables, (k, pair + 1)) * element(products, (pair + 1,))
        third += numbers(tables, (k, pair + 2)) * element(products, (pair + 2,))
        last += numbers(tables, (k, pair + 3)) * element(products, (pair + 3,))
    for pair in range(size - size % 4, size):
        one += numbers(tables, (k, pair)) * element(products, (pair,))
    return (one + other) + (third + last)


@written_out
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
