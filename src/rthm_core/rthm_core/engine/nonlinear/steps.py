"""Steps of a linear system that is driven by polynomials in time, compiled: as matrices, and as series.

A matrix has a row per element of [y, held, g_0, g_1, g_2, g_3], where the forces are
``g(t) = sum g_r (t / unit)^r``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from rthm_core.compiled import Floats, Integers, inlined

ORDERS = 4
"""Coefficients of the polynomial by which a force that is not constant is given over a step."""

MOST_TERMS = 64
"""Terms of the longest series, and the ``fastest * length`` that it can take."""
LONGEST_SERIES = 4.0


class Steps(NamedTuple):
    """Matrices of steps.

    Attributes
    ----------
    matrices : (K, stages, N + M + orders G, N) array
        After a third, two thirds and the whole of each length, or after the whole alone.
    filled : (K,) array
        Which of them are there.
    lengths : (K,) array
        In s.
    work_tables : (sets lengths, pairs, 8) array
        Work over each length, and the energy at its end, from the products of what describes the motion over
        it; empty where work is not counted, or not so.
    work, term : (2, N + M + orders G, N), (N + M + G + 1, N) arrays
        Scratch.
    """

    matrices: Floats
    filled: Integers
    lengths: Floats
    work_tables: Floats
    work: Floats
    term: Floats


@inlined
def terms_of(x):  # type: ignore[no-untyped-def]
    """How many terms of the exponential series of `x` count."""
    terms, size = 3, 1.0
    while size > 1e-18 and terms < MOST_TERMS - 1:
        size *= x / (terms - 2)
        terms += 1
    return terms


@inlined
def _next_term(system, term, share):  # type: ignore[no-untyped-def]
    """Term (., N) of the series that follows, in place."""
    n = system.shape[0]
    for j in range(term.shape[0] - 1):
        for i in range(n):
            total = 0.0
            for q in range(n):
                total += system[i, q] * term[j, q]
            term[term.shape[0] - 1, i] = total * share
        for i in range(n):
            term[j, i] = term[term.shape[0] - 1, i]


@inlined
def _copy(source, target):  # type: ignore[no-untyped-def]
    for j in range(source.shape[0]):
        for i in range(source.shape[1]):
            target[j, i] = source[j, i]


@inlined
def _taylor(system, length, unit, terms, term, out):  # type: ignore[no-untyped-def]
    """Matrix of a step of `length` by its series; `term` (d + 1, N) is scratch."""
    n, d = system.shape
    g = (out.shape[0] - d) // (ORDERS - 1)
    for j in range(out.shape[0]):
        for i in range(n):
            out[j, i] = 0.0
    for j in range(d):
        for i in range(n):
            term[j, i] = system[i, j] if j >= n else 1.0 if i == j else 0.0
    for k in range(terms):
        share = length / (k + 1)
        for j in range(d):
            for i in range(n):
                out[j, i] += term[j, i] * (1.0 if j < n else share)
        for j in range(d - g, d):
            weight = share
            for r in range(1, ORDERS):
                weight *= length / unit * r / (k + r + 1)
                for i in range(n):
                    out[j + r * g, i] += term[j, i] * weight
        _next_term(system, term, share)


@inlined
def _compose(first, shift, second, d, out):  # type: ignore[no-untyped-def]
    """Step `first`, of `shift` units, and then step `second` as one; d rows belong to [y, held, g_0]."""
    n = first.shape[1]
    g = (first.shape[0] - d) // (ORDERS - 1)
    for j in range(first.shape[0]):
        for i in range(n):
            total = 0.0 if j < n else second[j, i]
            for q in range(n):
                total += first[j, q] * second[q, i]
            out[j, i] = total
    for j in range(d - g, d):
        for r in range(1, ORDERS):
            weight = 1.0
            for q in range(r - 1, -1, -1):
                weight *= shift * (q + 1) / (r - q)
                for i in range(n):
                    out[j + r * g, i] += weight * second[j + q * g, i]


@inlined
def fill(system, fastest, steps, slot, length):  # type: ignore[no-untyped-def]
    """Make the matrices of a step of `length` seconds."""
    d, stages = system.shape[1], steps.matrices.shape[1]
    unit = length / stages
    halvings = max(0, math.ceil(math.log2(2.0 * fastest * unit))) if fastest * unit > 0.5 else 0
    part = unit * 0.5**halvings
    small, double, target = steps.work[0], steps.work[1], steps.matrices[slot]
    _taylor(system, part, unit, terms_of(fastest * part), steps.term, small)
    for _ in range(halvings):
        _compose(small, part / unit, small, d, double)
        _copy(double, small)
        part *= 2.0
    _copy(small, target[0])
    for stage in range(1, stages):
        _compose(target[stage - 1], float(stage), target[0], d, target[stage])


@inlined
def through(matrix, whole, out):  # type: ignore[no-untyped-def]
    """Product of a step's matrix, which has a row per element of `whole`, with it."""
    for i in range(matrix.shape[1]):
        out[i] = matrix[0, i] * whole[0]
    for j in range(1, matrix.shape[0]):
        for i in range(matrix.shape[1]):
            out[i] += matrix[j, i] * whole[j]


@inlined
def series(system, fastest, length, z, g, out):  # type: ignore[no-untyped-def]
    """Coefficients `out` (terms, N) of ``y(t) = sum out_k (t / length)^k``; `z` is [y, held, ...], and
    ``g[r]`` the coefficients of the forces in the same unit. Returns the number of terms.
    """
    n, d = system.shape
    first, terms = d - g.shape[1], terms_of(fastest * length) + g.shape[0]
    for i in range(n):
        out[0, i] = z[i]
    for k in range(terms - 1):
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += system[i, j] * out[k, j]
            if k == 0:
                for j in range(n, first):
                    total += system[i, j] * z[j]
            if k < g.shape[0]:
                for j in range(first, d):
                    total += system[i, j] * g[k, j - first]
            out[k + 1, i] = total * length / (k + 1)
    return terms


@inlined
def at(coefficients, terms, share, out):  # type: ignore[no-untyped-def]
    """The motion at a share of the step, into the leading elements of `out`."""
    for i in range(coefficients.shape[1]):
        total = coefficients[terms - 1, i]
        for k in range(terms - 2, -1, -1):
            total = total * share + coefficients[k, i]
        out[i] = total
