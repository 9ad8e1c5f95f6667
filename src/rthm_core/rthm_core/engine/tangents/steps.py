"""Tangents over a step of a linear system whose inputs are constant, compiled.

Where ``y' = S z`` with ``z = [y, held, g]``, the derivative dz of z with respect to parameters follows
``dy' = S dz + dS z``. The parameters are the last two axes: Q groups of `WIDTH`, which are worked on at once.
"""

from __future__ import annotations

from numba.cpython.unsafe.tuple import tuple_setitem

from rthm_core.compiled import inlined
from rthm_core.simd import (
    WIDTH,
    element,
    everywhere,
    numbers,
    numbers_from,
    put_numbers,
    put_numbers_from,
    several,
)


@inlined
def copy_numbers(source, target, count):  # type: ignore[no-untyped-def]
    """Copy the first `count` rows (., Q, 8)."""
    for i in range(count):
        for group in range(source.shape[1]):
            put_numbers(target, (i, group), numbers(source, (i, group)))


@inlined
def put_entries(matrix, change, entries, slot):  # type: ignore[no-untyped-def]
    """Let one of several matrices be a transposed matrix (d, rows) that changes by (d, rows, Q, 8)."""
    abreast = entries.rows.shape[1]
    for block in range(entries.rows.shape[0]):
        first, end = entries.ends[block], entries.ends[block + 1]
        for e in range(first, end):
            for i in range(abreast):
                entries.values[slot, abreast * e + i] = matrix[entries.columns[e], entries.rows[block, i]]
        for group in range(change.shape[2]):
            place = slot * entries.width + entries.places[block, group]
            for e in range(first, end if entries.places[block, group] >= 0 else first):
                for i in range(abreast):
                    beside = numbers(change, (entries.columns[e], entries.rows[block, i], group))
                    put_numbers_from(entries.changes, place, beside)
                    place += WIDTH


@inlined
def look_through(step, change, look):  # type: ignore[no-untyped-def]
    """What is seen after a transposed step (d, N) that changes by (d, N, Q, 8), into scratch of `look`."""
    rows, n = look.rows, step.shape[1]
    for j in range(step.shape[0]):
        for row in range(rows.shape[0]):
            look.matrix[j, row] = rows[row, j] if j >= n else 0.0
            for i in range(n):
                look.matrix[j, row] += rows[row, i] * step[j, i]
            for group in range(change.shape[2]):
                total = numbers(look.changes, (j, row, group)) if j >= n else everywhere(0.0)
                for i in range(n):
                    total += numbers(change, (j, i, group)) * rows[row, i]
                    total += numbers(look.changes, (i, row, group)) * step[j, i]
                put_numbers(look.change, (j, row, group), total)


@inlined
def of_block(entries, slot, block, z, lanes, at, groups, like):  # type: ignore[no-untyped-def]
    """Tangents (8,), SIMD values, of all rows of a block of what one of several matrices makes of z, those of
    all groups of a row side by side.

    The flat `lanes` have the tangents of each element of z one after another from `at` on. Tuples as long as
    there are `groups`, and `like` the result, let the compiler keep the sums in registers.
    """
    sums, each = several(like), len(like) // len(groups)
    first, end = element(entries.ends, (block,)), element(entries.ends, (block + 1,))
    for e in range(first, end):
        column = element(entries.columns, (e,))
        begin, here = at + column * (len(groups) * WIDTH), element(z, (column,))
        for group in range(len(groups)):
            moving = numbers_from(lanes, begin + group * WIDTH)
            for i in range(each):
                part = moving * element(entries.values, (slot, e * each + i))
                sums = tuple_setitem(sums, i * len(groups) + group, sums[i * len(groups) + group] + part)
        for group in range(len(groups)):
            place = element(entries.places, (block, group))
            if place >= 0:
                c = slot * entries.width + place + (e - first) * (each * WIDTH)
                for i in range(each):
                    part = numbers_from(entries.changes, c + i * WIDTH) * here
                    sums = tuple_setitem(sums, i * len(groups) + group, sums[i * len(groups) + group] + part)
    return sums


@inlined
def next_term(system, change, share, z, dz, out):  # type: ignore[no-untyped-def]
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
    next_term(system, change, length, z, dz, one)
    for k in range(1, terms):
        next_term(system, change, length / (k + 1), one.y, one.dy, other)
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
