"""Tangents over a step of a linear system whose inputs are constant, compiled.

Where ``y' = S z`` with ``z = [y, held, g]``, the derivative dz of z with respect to parameters follows
``dy' = S dz + dS z``. The parameters are the last two axes: groups, and `LANES` in each, which fill a
register.
"""

from __future__ import annotations

from rthm_core.compiled import inlined

LANES = 4
"""Parameters in a group; where it counts they are written out, so that the compiler joins them."""


@inlined
def by_matrix(matrix, change, columns, z, dz, out):  # type: ignore[no-untyped-def]
    """Tangents (N, Q, 4) of what a transposed matrix (., N), which changes as well (., N, Q, 4), makes of z;
    `columns` (N, .) has the number of elements of z that count for a row, and then these.
    """
    for i in range(out.shape[0]):
        for group in range(out.shape[1]):
            first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
            for at in range(1, columns[i, 0] + 1):
                j = columns[i, at]
                m, s = matrix[j, i], z[j]
                first += m * dz[j, group, 0] + s * change[j, i, group, 0]
                second += m * dz[j, group, 1] + s * change[j, i, group, 1]
                third += m * dz[j, group, 2] + s * change[j, i, group, 2]
                fourth += m * dz[j, group, 3] + s * change[j, i, group, 3]
            out[i, group, 0], out[i, group, 1] = first, second
            out[i, group, 2], out[i, group, 3] = third, fourth


@inlined
def _term(system, change, share, z, dz, out):  # type: ignore[no-untyped-def]
    """Next term of the series of y, and its tangents, into `out`, from the leading elements of z and dz."""
    for i in range(system.shape[0]):
        total = 0.0
        for j in range(z.size):
            total += system[i, j] * z[j]
        out.y[i] = total * share
        for group in range(dz.shape[1]):
            for lane in range(LANES):
                total = 0.0
                for j in range(z.size):
                    total += system[i, j] * dz[j, group, lane] + change[i, j, group, lane] * z[j]
                out.dy[i, group, lane] = total * share


@inlined
def by_series(system, change, length, terms, z, dz, one, other, out):  # type: ignore[no-untyped-def]
    """Tangents (N, Q, 4) after a step of `length` (s), by the series; `one` and `other` are scratch."""
    for i in range(out.shape[0]):
        for group in range(out.shape[1]):
            for lane in range(LANES):
                out[i, group, lane] = dz[i, group, lane]
    _term(system, change, length, z, dz, one)
    for k in range(1, terms):
        _term(system, change, length / (k + 1), one.y, one.dy, other)
        for i in range(out.shape[0]):
            for group in range(out.shape[1]):
                for lane in range(LANES):
                    out[i, group, lane] += one.dy[i, group, lane]
                    one.dy[i, group, lane] = other.dy[i, group, lane]
            one.y[i] = other.y[i]


@inlined
def fill_change(system, change, length, terms, unit, zero, one, other, out):  # type: ignore[no-untyped-def]
    """Change (d, N, Q, 4) of a step's matrix, column by column; `unit` (d,), `zero` (d, Q, 4) are scratch."""
    for j in range(unit.size):
        for i in range(unit.size):
            unit[i] = 1.0 if i == j else 0.0
        by_series(system, change, length, terms, unit, zero, one, other, out[j])
