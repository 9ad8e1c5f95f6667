"""Matrices of steps as SIMD values, compiled: made when a step is first taken."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, inlined
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.steps import Steps, fill
from rthm_core.lent import given
from rthm_core.simd import WIDTH, everywhere, numbers, put_numbers, put_numbers_from, simd_empty

HALVINGS = 6
"""How often a length is halved whose halves are kept."""


class Packed(NamedTuple):
    """Steps by slot (K): numbered by the set that sticks, then by how often the length was halved, then by
    the length; the last is for any other length.

    Attributes
    ----------
    after : (K, rows, Q, 8) array
        State at the end of each step.
    stages : (K, rows, P, 8) array
        What the laws feel after each third, one after the other; no groups where forces are constant.
    seen : (K, rows, V, 8) array
        What is seen at the end of each step.
    columns : (d, V, 8) array
        What is seen of [y, held, g]: x1, v1, forces in the wires, x2, v2, measured motion, F_d, side by side.
    filled : (K,) array
        Which are there.
    whole : int
        Number of lengths that are no halves.
    """

    after: Floats
    stages: Floats
    seen: Floats
    columns: Floats
    filled: Integers
    whole: int


def packed(steps: Steps, nonlinear: Nonlinear, columns: Floats, whole: int) -> Packed:
    """Room for the steps, none of which is there yet."""
    slots, stages, rows, size = steps.matrices.shape
    groups = [-(-count // WIDTH) for count in (size, stages * nonlinear.felt.size if stages > 1 else 0)]
    after, felt, seen = (simd_empty(slots, rows, count, WIDTH) for count in (*groups, columns.shape[1]))
    return Packed(after, felt, seen, columns, np.zeros(slots, dtype=np.int64), whole)


@inlined
def _put_rows(matrix, columns, begin, target):  # type: ignore[no-untyped-def]
    """Write columns of a step's matrix side by side."""
    for row in range(matrix.shape[0]):
        for i in range(columns.size):
            place = begin + i
            target[row, place // WIDTH, place % WIDTH] = matrix[row, columns[i]]


@inlined
def _put_seen(matrix, g, columns, seen, slot):  # type: ignore[no-untyped-def]
    """Write what is seen at the end of a step, where inputs are as they were at its start but for `g` forces:
    polynomials in thirds of it.
    """
    size, first = matrix.shape[1], columns.shape[0] - g
    for row in range(matrix.shape[0]):
        order = max(row - first, 0) // max(g, 1)
        element, factor = row - order * g, 3.0**order
        for group in range(columns.shape[1]):
            total = everywhere(0.0)
            if element >= size:
                total += numbers(columns, (element, group)) * factor
            for i in range(size):
                total += numbers(columns, (i, group)) * matrix[row, i]
            put_numbers(seen, (slot, row, group), total)


@called
def _make(nonlinear, steps, packed, number, slot, length):  # type: ignore[no-untyped-def]
    """Make the step of `length` seconds in a slot."""
    if not steps.filled[slot] or slot == steps.filled.size - 1:
        fill(nonlinear.systems[number], nonlinear.fastest, steps, slot, length)
        steps.filled[slot] = 1
    matrices, after = steps.matrices[slot], packed.after[slot]
    last = matrices.shape[0] - 1
    for row in range(after.shape[0]):
        for i in range(matrices.shape[2]):
            after[row, i // WIDTH, i % WIDTH] = matrices[last, row, i]
    if packed.stages.shape[2]:
        for stage in range(matrices.shape[0]):
            _put_rows(matrices[stage], nonlinear.felt, stage * nonlinear.felt.size, packed.stages[slot])
    _put_seen(matrices[last], nonlinear.weight.size, packed.columns, packed.seen, slot)
    packed.filled[slot] = 1


@inlined
def prepare(nonlinear, steps, packed, number, slot, length):  # type: ignore[no-untyped-def]
    """Make the step of `length` seconds in a slot, if it is not there."""
    if not packed.filled[slot] or slot == packed.filled.size - 1:
        _make(given(nonlinear), given(steps), given(packed), number, slot, length)


@inlined
def wide_product(matrices, slot, whole, out):  # type: ignore[no-untyped-def]
    """What matrices (K, rows, groups, 8) make in a slot of `whole`, into `out` (8 groups,)."""
    size = whole.size
    for group in range(matrices.shape[2]):
        one = other = everywhere(0.0)  # side by side: a sum waits for the one before
        for j in range(0, size - 1, 2):
            one += numbers(matrices, (slot, j, group)) * whole[j]
            other += numbers(matrices, (slot, j + 1, group)) * whole[j + 1]
        if size % 2:
            one += numbers(matrices, (slot, size - 1, group)) * whole[size - 1]
        put_numbers_from(out, group * WIDTH, one + other)


@inlined
def see(columns, z, out):  # type: ignore[no-untyped-def]
    """Everything that is seen of ``z = [y, held, g]``, side by side."""
    for group in range(columns.shape[1]):
        total = everywhere(0.0)
        for j in range(columns.shape[0]):
            total += numbers(columns, (j, group)) * z[j]
        put_numbers_from(out, group * WIDTH, total)


@inlined
def end_of(packed, slot, whole, wide, out):  # type: ignore[no-untyped-def]
    """State at the end of the step that `whole` describes, into the leading elements of `out`; `wide` is
    scratch.
    """
    wide_product(packed.after, slot, whole, wide)
    for i in range(out.size):
        out[i] = wide[i]
