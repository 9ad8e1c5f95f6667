"""Steps of eight linear systems at once, compiled; the last axis of every array are the systems."""

from __future__ import annotations

import math

from rthm_core.compiled import Floats, called, inlined
from rthm_core.engine.nonlinear.steps import terms_of
from rthm_core.simd import numbers, put_numbers


@inlined
def _product(start: Floats, factor: float, a: Floats, b: Floats, out: Floats) -> None:
    """Let `out` be ``factor start + a b``, where inputs have no rates: all are (states, n, 8), and `out` is
    none of the others.
    """
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            total = numbers(start, (i, j)) * factor
            for k in range(a.shape[0]):
                total += numbers(a, (i, k)) * numbers(b, (k, j))
            put_numbers(out, (i, j), total)


@inlined
def _scaled(a: Floats, factor: float, out: Floats) -> None:
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            put_numbers(out, (i, j), numbers(a, (i, j)) * factor)


@inlined
def _largest(a: Floats) -> float:
    """Largest row sum of matrices (states, n, 8)."""
    largest = 0.0
    for i in range(a.shape[0]):
        for lane in range(a.shape[2]):
            total = 0.0
            for j in range(a.shape[1]):
                total += abs(a[i, j, lane])
            largest = max(largest, total)
    return largest


@inlined
def _exponential(a: Floats, t: float, largest: float, x: Floats, grown: Floats, work: Floats) -> None:
    """``exp(a t) - 1`` of matrices (states, n, 8) into `grown`, by scaling and squaring of the series;
    `largest` is their largest row sum times `t`.
    """
    halvings = max(0, math.ceil(math.log2(2.0 * largest))) if largest > 0.5 else 0
    terms = terms_of(largest * 0.5**halvings)
    _scaled(a, t * 0.5**halvings, x)
    _scaled(x, 1.0 / terms, grown)
    for k in range(terms - 1, 0, -1):
        _product(x, 1.0, x, grown, work)
        _scaled(work, 1.0 / k, grown)
    for _ in range(halvings):
        _product(grown, 2.0, grown, grown, work)
        _scaled(work, 1.0, grown)


@called
def fill_steps(a, lengths, steps, work):  # type: ignore[no-untyped-def]
    """Step matrices (K, n, states, 8), transposed, over each of the lengths (s), of dynamics (states, n, 8).

    `work` (3, states, n, 8) is scratch.
    """
    x, grown, largest = work[0], work[1], _largest(a)
    for k in range(lengths.size):
        _exponential(a, lengths[k], largest * lengths[k], x, grown, work[2])
        for i in range(steps.shape[2]):
            for j in range(steps.shape[1]):
                same = 1.0 if i == j else 0.0
                put_numbers(steps, (k, j, i), numbers(grown, (i, j)) + same)
