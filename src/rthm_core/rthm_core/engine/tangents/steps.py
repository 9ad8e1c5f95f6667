"""Tangents over a step of a linear system whose inputs are constant, compiled.

Where ``y' = S z`` with ``z = [y, held, g]``, the derivative dz of z with respect to parameters follows
``dy' = S dz + dS z``. The parameters are the last two axes: Q groups of `WIDTH`, which are worked on at once.
"""

from __future__ import annotations

from numba.cpython.unsafe.tuple import tuple_setitem

from rthm_core.compiled import inlined
from rthm_core.simd import everywhere, numbers, put_numbers, several


@inlined
def copy_numbers(source, target, count):  # type: ignore[no-untyped-def]
    """Copy the first `count` rows (., Q, 8)."""
    for i in range(count):
        for group in range(source.shape[1]):
            put_numbers(target, (i, group), numbers(source, (i, group)))


@inlined
def put_pairs(matrix, change, pairs, number):  # type: ignore[no-untyped-def]
    """Let one of the matrices of `by_pairs` be a transposed matrix (., N) that changes by (., N, Q, 8)."""
    last = matrix.shape[1] - 1
    for pair in range(pairs.columns.shape[0]):
        for at in range(1, pairs.columns[pair, 0] + 1):
            j = pairs.columns[pair, at]
            for side in range(2):
                i = min(2 * pair + side, last)
                pairs.values[number, pair, at, side] = matrix[j, i]
                for group in range(change.shape[2]):
                    beside = numbers(change, (j, i, group))
                    put_numbers(pairs.changes, (number, pair, at, side, group), beside)


@inlined
def by_pairs(columns, values, changes, number, z, dz, groups, rows, out):  # type: ignore[no-untyped-def]
    """What a matrix of so many `rows` makes of z, and its tangents (., Q, 8).

    The matrix, one of several, is given two rows at a time, for which `columns` (N / 2, .) has the number of
    elements of z that count, and then these; `values` (., N / 2, ., 2) and `changes` (., N / 2, ., 2, Q, 8)
    have what belongs to each. A tuple of Q `groups` lets the compiler keep the sums in registers.
    """
    for pair in range(columns.shape[0]):
        one, other = several(groups), several(groups)
        for at in range(1, columns[pair, 0] + 1):
            j = columns[pair, at]
            here, first, second = z[j], values[number, pair, at, 0], values[number, pair, at, 1]
            for group in range(len(groups)):
                moving = numbers(dz, (j, group))
                change = numbers(changes, (number, pair, at, 0, group))
                one = tuple_setitem(one, group, one[group] + first * moving + here * change)
                change = numbers(changes, (number, pair, at, 1, group))
                other = tuple_setitem(other, group, other[group] + second * moving + here * change)
        i, k = 2 * pair, min(2 * pair + 1, rows - 1)
        for group in range(len(groups)):
            put_numbers(out, (i, group), one[group])
            put_numbers(out, (k, group), other[group])


@inlined
def _term(system, change, share, z, dz, out):  # type: ignore[no-untyped-def]
    """Next term of the series of y, and its tangents, into `out`, from the leading elements of z and dz."""
    for i in range(system.shape[0]):
        total = 0.0
        for j in range(z.size):
            total += system[i, j] * z[j]
        out.y[i] = total * share
        for group in range(dz.shape[1]):
            tangent = everywhere(0.0)
            for j in range(z.size):
                tangent += system[i, j] * numbers(dz, (j, group)) + numbers(change, (i, j, group)) * z[j]
            put_numbers(out.dy, (i, group), tangent * share)


@inlined
def by_series(system, change, length, terms, z, dz, one, other, out):  # type: ignore[no-untyped-def]
    """Tangents (N, Q, 8) after a step of `length` (s), by the series; `one` and `other` are scratch."""
    copy_numbers(dz, out, out.shape[0])
    _term(system, change, length, z, dz, one)
    for k in range(1, terms):
        _term(system, change, length / (k + 1), one.y, one.dy, other)
        for i in range(out.shape[0]):
            for group in range(out.shape[1]):
                put_numbers(out, (i, group), numbers(out, (i, group)) + numbers(one.dy, (i, group)))
            one.y[i] = other.y[i]
        copy_numbers(other.dy, one.dy, out.shape[0])
    for i in range(out.shape[0]):
        for group in range(out.shape[1]):
            put_numbers(out, (i, group), numbers(out, (i, group)) + numbers(one.dy, (i, group)))


@inlined
def fill_change(system, change, length, terms, unit, zero, one, other, out):  # type: ignore[no-untyped-def]
    """Change (d, N, Q, 8) of a step's matrix, column by column; `unit` (d,), `zero` (d, Q, 8) are scratch."""
    for j in range(unit.size):
        for i in range(unit.size):
            unit[i] = 1.0 if i == j else 0.0
        by_series(system, change, length, terms, unit, zero, one, other, out[j])
