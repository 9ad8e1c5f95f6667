"""Tangents over a step of a linear system whose inputs are constant, compiled.

Where ``y' = S z`` with ``z = [y, held, g]``, the derivative dz of z with respect to parameters follows
``dy' = S dz + dS z``. The parameters are the last two axes: Q groups of `WIDTH`, which are worked on at once.
"""

from __future__ import annotations

import numpy as np
from numba.cpython.unsafe.tuple import tuple_setitem

from rthm_core.compiled import called, inlined
from rthm_core.simd import WIDTH, everywhere, numbers, numbers_from, put_numbers, put_numbers_from, several


@inlined
def copy_numbers(source, target, count):  # type: ignore[no-untyped-def]
    """Copy the first `count` rows (., Q, 8)."""
    for i in range(count):
        for group in range(source.shape[1]):
            put_numbers(target, (i, group), numbers(source, (i, group)))


@inlined
def put_entries(matrix, change, entries, slot):  # type: ignore[no-untyped-def]
    """Let one of several matrices be a transposed matrix (d, rows) that changes by (d, rows, Q, 8)."""
    c = slot * entries.width
    for block in range(entries.rows.shape[0]):
        for e in range(entries.ends[block], entries.ends[block + 1]):
            j = entries.columns[e]
            for side in range(2):
                entries.values[slot, 2 * e + side] = matrix[j, entries.rows[block, side]]
            for group in range(change.shape[2]):
                if entries.touched[block, group]:
                    for side in range(2):
                        beside = numbers(change, (j, entries.rows[block, side], group))
                        put_numbers_from(entries.changes, c, beside)
                        c += WIDTH


@called
def by_entries(entries, slot, z, lanes, at, groups, out, to):  # type: ignore[no-untyped-def]
    """What one of several matrices makes of z, and its tangents.

    Both `lanes` and `out` are flat and have the tangents of one element after the other, those of z from `at`
    on and those of what comes of it from `to` on. A tuple of Q `groups` lets the compiler keep the sums in
    registers.
    """
    columns, touched, values, changes = entries.columns, entries.touched, entries.values, entries.changes
    k, c, width = np.uint64(slot), slot * entries.width, len(groups) * WIDTH
    for block in range(touched.shape[0]):
        one, other, by_one, by_other = several(groups), several(groups), several(groups), several(groups)
        both = entries.rows[block, 0] != entries.rows[block, 1]
        for e in range(entries.ends[block], entries.ends[block + 1]):
            j = columns[np.uint64(e)]
            here, first = z[np.uint64(j)], values[k, np.uint64(2 * e)]
            second = values[k, np.uint64(2 * e + 1)]
            for group in range(len(groups)):
                moving = numbers_from(lanes, at + j * width + group * WIDTH)
                one = tuple_setitem(one, group, one[group] + moving * first)
                if both:
                    other = tuple_setitem(other, group, other[group] + moving * second)
                if touched[np.uint64(block), np.uint64(group)]:
                    change = numbers_from(changes, c)
                    by_one = tuple_setitem(by_one, group, by_one[group] + change * here)
                    if both:
                        change = numbers_from(changes, c + WIDTH)
                        by_other = tuple_setitem(by_other, group, by_other[group] + change * here)
                    c += 2 * WIDTH
        one_at, other_at = to + entries.rows[block, 0] * width, to + entries.rows[block, 1] * width
        for group in range(len(groups)):
            put_numbers_from(out, one_at + group * WIDTH, one[group] + by_one[group])
            if both:
                put_numbers_from(out, other_at + group * WIDTH, other[group] + by_other[group])


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
