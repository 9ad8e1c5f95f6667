"""Matrices and how they change with parameters, as streams of numbers that compiled code runs through."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Flags, Floats, Integers
from rthm_core.engine.nonlinear.loop import NonlinearLoop
from rthm_core.engine.tangents.changes import Tangents, reach
from rthm_core.simd import WIDTH, simd_empty


class Entries(NamedTuple):
    """Matrices of the same form, in blocks of two rows (twice the same where there is no other like it).

    Attributes
    ----------
    rows : (B, 2) array
        Numbers of the rows of each block.
    ends : (B + 1,) array
        Where the entries of each block begin, and those of the last end.
    columns : (E,) array
        Element that belongs to each entry.
    touched : (B, Q) array
        Which groups of parameters change a block: 1, else 0.
    values, changes : (K, 2 E), (K width,) arrays
        Of each entry of K matrices those of both rows, and the changes of both in each group that is touched.
    width : int
        How many numbers the changes of a matrix are.
    """

    rows: Integers
    ends: Integers
    columns: Integers
    touched: Integers
    values: Floats
    changes: Floats
    width: int


def entries(pattern: Flags, touched: Flags, count: int) -> Entries:
    """Room for `count` matrices whose elements are zero but for a `pattern` (rows, d), and whose rows change
    with the groups of parameters that are `touched` (rows, Q).
    """
    rows = _blocks(pattern)
    both = pattern[rows].any(axis=1)
    groups = touched[rows].any(axis=1)
    ends = np.concatenate([[0], np.cumsum(both.sum(axis=1))])
    width = 2 * WIDTH * int((both.sum(axis=1) * groups.sum(axis=1)).sum())
    return Entries(
        rows,
        ends.astype(np.int64),
        np.nonzero(both)[1].astype(np.int64),
        np.asarray(groups, dtype=np.int64),
        np.empty((count, 2 * int(ends[-1]))),
        simd_empty(count * width),
        width,
    )


def _blocks(pattern: Flags) -> Integers:
    """Rows, two and two whose elements are the same ones where there are such; others twice."""
    left, found = list(range(pattern.shape[0])), []
    while left:
        row = left.pop(0)
        other = next((one for one in left if np.array_equal(pattern[one], pattern[row])), row)
        if other != row:
            left.remove(other)
        found.append((row, other))
    return np.array(found, dtype=np.int64)


def step_entries(loop: NonlinearLoop, changes: Tangents, slots: int) -> Entries:
    """Room for the matrices (N, d) of so many steps, which are made when they are needed."""
    systems = np.abs(loop.nonlinear.systems).sum(axis=0) + np.abs(changes.systems).sum(axis=(0, 3, 4))
    reached, n = reach(systems), systems.shape[0]
    pattern = np.hstack([reached, reached.astype(int) @ (systems[:, n:] != 0.0) > 0])
    changed = np.any(changes.systems != 0.0, axis=(0, 2, 4))
    return entries(pattern, reached.astype(int) @ changed > 0, slots)


def look_entries(rows: Floats, changes: Floats) -> Entries:
    """What is seen of [y, held] through `rows` (., N + M), with their transposed `changes`."""
    changed = np.any(changes != 0.0, axis=3)
    one = entries((rows != 0.0) | changed.any(axis=2).T, changed.any(axis=0), 1)
    block_of = np.repeat(np.arange(one.touched.shape[0]), np.diff(one.ends))
    one.values[0] = rows[one.rows[block_of], one.columns[:, None]].ravel()
    beside = [
        changes[j, row, group]
        for block, j in zip(block_of, one.columns, strict=True)
        for group in np.flatnonzero(one.touched[block])
        for row in one.rows[block]
    ]
    one.changes[:] = np.ravel(beside)
    return one
