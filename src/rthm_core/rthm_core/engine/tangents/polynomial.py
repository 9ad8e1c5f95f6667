"""Tangents over a step whose forces are polynomials in time, compiled: by their series, and as matrices."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import called, inlined
from rthm_core.engine.nonlinear.steps import ORDERS, terms_of
from rthm_core.engine.tangents.steps import copy_numbers, next_term, put_entries
from rthm_core.simd import everywhere, numbers, put_numbers

STAGES = ORDERS - 1
"""How many parts of a step there are after each of which forces are computed."""

FIT = np.array(
    [[1.0, 0.0, 0.0, 0.0], [-11.0, 18.0, -9.0, 2.0], [6.0, -15.0, 12.0, -3.0], [-1.0, 3.0, -3.0, 1.0]]
) / np.array([[1.0], [6.0], [6.0], [6.0]])
"""Coefficients of a polynomial, in thirds of a step, from its values at the start and after each third."""


@inlined
def _begin(whole, dwhole, one):  # type: ignore[no-untyped-def]
    """First term of a series."""
    copy_numbers(dwhole, one.dy, one.y.size)
    for j in range(one.y.size):
        one.y[j] = whole[j]


@inlined
def _drive(whole, dwhole, order, n, g, one):  # type: ignore[no-untyped-def]
    """Let what drives a further term be the forces of an order, and the held inputs nothing."""
    first, factor = one.y.size - g, 3.0**order
    for j in range(n, one.y.size):
        row = first + order * g + (j - first)
        driven = j >= first and order < ORDERS
        one.y[j] = whole[row] * factor if driven else 0.0
        for group in range(one.dy.shape[1]):
            put_numbers(
                one.dy, (j, group), numbers(dwhole, (row, group)) * factor if driven else everywhere(0.0)
            )


@called
def through_series(  # type: ignore[no-untyped-def]
    system, change, fastest, length, share, whole, dwhole, one, other, out
):
    """Tangents (., N, Q, 8) of y after equal parts of a `share` of a step of `length` (s), which `whole`
    describes, with tangents `dwhole`; `one` and `other` are scratch.
    """
    n, g, parts = system.shape[0], (whole.size - system.shape[1]) // (ORDERS - 1), out.shape[0]
    _begin(whole, dwhole, one)
    for part in range(parts):
        copy_numbers(dwhole, out[part], n)
    for k in range(terms_of(fastest * length) + ORDERS):
        columns = one.y.size if k < ORDERS else n
        next_term(system, change, length / (k + 1), one.y[:columns], one.dy, other)
        for part in range(parts):
            factor = (share * (part + 1) / parts) ** (k + 1)
            for i in range(n):
                for group in range(out.shape[2]):
                    total = numbers(out, (part, i, group)) + numbers(other.dy, (i, group)) * factor
                    put_numbers(out, (part, i, group), total)
        copy_numbers(other.dy, one.dy, n)
        for i in range(n):
            one.y[i] = other.y[i]
        if k < ORDERS:
            _drive(whole, dwhole, k + 1, n, g, one)


@inlined
def find_influence(matrices, felt, g, out):  # type: ignore[no-untyped-def]
    """How what is felt after each third of a step (stages felt, stages G) depends on the forces there; the
    `matrices` (stages, rows, N) are those of the step.
    """
    rows = matrices.shape[1]
    first = rows - ORDERS * g
    for stage in range(STAGES):
        for i in range(felt.size):
            for at in range(STAGES):
                for j in range(g):
                    total = 0.0
                    for order in range(1, ORDERS):
                        total += matrices[stage, first + order * g + j, felt[i]] * FIT[order, at + 1]
                    out[stage * felt.size + i, at * g + j] = total


@called
def make_changes(nonlinear, steps, tangents, changes, own, number, slot, length):  # type: ignore[no-untyped-def]
    """Make the changes of the matrices of a step, which are there."""
    felt, matrices = nonlinear.felt, steps.matrices[slot]
    for j in range(own.unit.size):
        for i in range(own.unit.size):
            own.unit[i] = 1.0 if i == j else 0.0
        through_series(
            nonlinear.systems[number], tangents.systems[number], nonlinear.fastest, length, 1.0,
            own.unit, own.zero, own.one, own.other, own.column,
        )  # fmt: skip
        copy_numbers(own.column[STAGES - 1], own.after_change[j], matrices.shape[2])
        for stage in range(STAGES):
            for i in range(felt.size):
                row = stage * felt.size + i
                own.stage_matrix[j, row] = matrices[stage, j, felt[i]]
                for group in range(own.column.shape[2]):
                    change = numbers(own.column, (stage, felt[i], group))
                    put_numbers(own.stage_change, (j, row, group), change)
    put_entries(matrices[STAGES - 1], own.after_change, changes.after, slot)
    put_entries(own.stage_matrix, own.stage_change, changes.stages, slot)
    find_influence(matrices, felt, nonlinear.weight.size, changes.influence[slot])
    changes.filled[slot] = 1
