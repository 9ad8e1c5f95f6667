"""Matrices and how they change with parameters, as streams of numbers that compiled code runs through."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Flags, Floats, Integers
from rthm_core.engine.nonlinear.loop import NonlinearLoop
from rthm_core.engine.tangents.changes import Tangents, reach
from rthm_core.simd import WIDTH, simd_copy, simd_empty

PAIRS, TRIPLES = 2, 3
"""Rows of a block: position and velocity of a dof depend on the same, and the force of an actuator there."""


class Entries(NamedTuple):
    """Matrices of the same form, in blocks of A rows (the last again where there is no other like it).

    Attributes
    ----------
    rows : (B, A) array
        Numbers of the rows of each block.
    ends : (B + 1,) array
        Where the entries of each block begin, and those of the last end.
    columns : (E,) array
        Element that belongs to each entry.
    places : (B, Q) array
        Where the changes of a block by a group of parameters begin, -1: they are none.
    values, changes : (K, A E), (K width,) arrays
        Of each entry of K matrices those of all rows, and the changes of all by each group, one group after
        the other.
    width : int
        How many numbers the changes of a matrix are.
    """

    rows: Integers
    ends: Integers
    columns: Integers
    places: Integers
    values: Floats
    changes: Floats
    width: int


class Look(NamedTuple):
    """What is seen of the motion after each step, as matrices of the motion before it.

    Attributes
    ----------
    rows, changes : (R, d), (d, R, Q, 8) arrays
        What is seen of [y, held, g], and its transposed changes.
    triples, pairs : Entries
        All rows once, in blocks of three and of two: of K steps, and last as it is without a step.
    matrix, change : (d, R), (d, R, Q, 8) arrays
        Scratch.
    """

    rows: Floats
    changes: Floats
    triples: Entries
    pairs: Entries
    matrix: Floats
    change: Floats


def entries(pattern: Flags, touched: Flags, count: int, rows: Integers) -> Entries:
    """Room for `count` matrices whose elements are zero but for a `pattern` (rows, d), and whose rows change
    with the groups of parameters that are `touched` (rows, Q), in blocks of `rows` (B, A).
    """
    abreast, every, groups = rows.shape[1], pattern[rows].any(axis=1), touched[rows].any(axis=1)
    sizes = abreast * WIDTH * every.sum(axis=1)[:, None] * groups
    begins = np.cumsum(sizes).reshape(sizes.shape) - sizes
    ends = np.concatenate([[0], np.cumsum(every.sum(axis=1))])
    width = int(sizes.sum())
    return Entries(
        rows,
        ends.astype(np.int64),
        np.nonzero(every)[1].astype(np.int64),
        np.where(groups, begins, -1).astype(np.int64),
        np.empty((count, abreast * int(ends[-1]))),
        simd_empty(count * width),
        width,
    )


def in_blocks(pattern: Flags, widest: int) -> tuple[Integers, Integers]:
    """Rows in blocks of three (., 3), if these are the `widest`, and of two (., 2), the last again where a
    row is left: those of a block have the same elements.
    """
    left, triples, pairs = list(range(pattern.shape[0])), [], []
    while left:
        alike = [row for row in left if np.array_equal(pattern[row], pattern[left[0]])]
        left = [row for row in left if row not in alike]
        while widest == TRIPLES and len(alike) not in (0, 1, 2, 4):
            triples.append([alike.pop(0) for _ in range(TRIPLES)])
        pairs += [[*alike[i : i + PAIRS], alike[-1]][:PAIRS] for i in range(0, len(alike), PAIRS)]
    return (
        np.array(sorted(triples), dtype=np.int64).reshape(-1, TRIPLES),
        np.array(sorted(pairs), dtype=np.int64).reshape(-1, PAIRS),
    )


def step_entries(loop: NonlinearLoop, changes: Tangents, slots: int) -> Entries:
    """Room for the matrices (N, d) of so many steps, which are made when they are needed."""
    pattern, touched = of_steps(loop, changes)
    return entries(pattern, touched, slots, in_blocks(pattern, PAIRS)[1])


def of_steps(loop: NonlinearLoop, changes: Tangents) -> tuple[Flags, Flags]:
    """Pattern (N, d) of steps, and which groups (N, Q) change their rows."""
    systems = np.abs(loop.nonlinear.systems).sum(axis=0) + np.abs(changes.systems).sum(axis=(0, 3, 4))
    reached, n = reach(systems), systems.shape[0]
    pattern = np.hstack([reached, reached.astype(int) @ (systems[:, n:] != 0.0) > 0])
    changed = np.any(changes.systems != 0.0, axis=(0, 2, 4))
    return pattern, reached.astype(int) @ changed > 0


def look(
    loop: NonlinearLoop, changes: Tangents, rows: Floats, moved: Floats, slots: int, widest: int
) -> Look:
    """What is seen through `rows` (R, d), with transposed changes `moved` (d, R, Q, 8), after so many steps,
    for which there is room, and without one; in blocks that have up to two or three rows.
    """
    pattern, groups = _of_look(loop, changes, rows, moved)
    triples, pairs = (entries(pattern, groups, slots + 1, blocks) for blocks in in_blocks(pattern, widest))
    for room in (triples, pairs):
        _put_last(room, rows, moved)
    moved = simd_copy(moved)
    return Look(rows, moved, triples, pairs, np.empty((moved.shape[0], rows.shape[0])), simd_copy(moved))


def by_blocks(loop: NonlinearLoop, changes: Tangents, rows: Floats, moved: Floats) -> Integers:
    """Order in which the blocks of such a look have its rows."""
    blocks = in_blocks(_of_look(loop, changes, rows, moved)[0], TRIPLES)
    return np.array(list(dict.fromkeys(np.concatenate([one.ravel() for one in blocks]).tolist())))


def _of_look(loop: NonlinearLoop, changes: Tangents, rows: Floats, moved: Floats) -> tuple[Flags, Flags]:
    """Pattern (R, d) of what is seen after a step, and which groups (R, Q) change its rows."""
    (step, touched), n = of_steps(loop, changes), loop.nonlinear.systems.shape[1]
    changed = np.any(moved != 0.0, axis=3)
    through = (rows != 0.0) | changed.any(axis=2).T
    beneath = through[:, :n].astype(int)
    return through | (beneath @ step > 0), changed.any(axis=0) | (beneath @ touched > 0)


def look_entries(rows: Floats, changes: Floats) -> Entries:
    """What is seen of [y, held, g] through `rows` (R, d), with transposed `changes` (d, R, Q, 8)."""
    changed = np.any(changes != 0.0, axis=3)
    pattern = (rows != 0.0) | changed.any(axis=2).T
    one = entries(pattern, changed.any(axis=0), 1, in_blocks(pattern, PAIRS)[1])
    _put_last(one, rows, changes)
    return one


def _put_last(room: Entries, rows: Floats, changes: Floats) -> None:
    """Let the last matrix be `rows`, which change by `changes`."""
    blocks = np.repeat(np.arange(room.rows.shape[0]), np.diff(room.ends))
    room.values[-1] = rows[room.rows[blocks], room.columns[:, None]].ravel()
    last = room.changes[room.changes.size - room.width :]
    for block, group in zip(*np.nonzero(room.places >= 0), strict=True):
        columns = room.columns[room.ends[block] : room.ends[block + 1], None]
        begin, beside = room.places[block, group], changes[columns, room.rows[block], group]
        last[begin : begin + beside.size] = beside.ravel()
