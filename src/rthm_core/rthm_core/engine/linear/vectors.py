"""States and inputs in the compiled kernel of linear loops, and the matrices that act on them.

A small state is a tuple of numbers, whose length is part of the type: the compiler writes its loops out and
keeps it in registers. A larger one is an array. Both take the same kernel.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.core import types
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import overload

from rthm_core.compiled import FUSED, Floats
from rthm_core.simd import WIDTH, everywhere, numbers, put_first, simd_empty

LONGEST_IN_REGISTERS = 6
"""Longest state that is kept in registers."""

Vector = tuple[float, ...] | Floats
"""Numbers of a state or an input: a tuple up to the length `LONGEST_IN_REGISTERS`, else an array."""


def vector(values: Floats) -> Vector:
    """State or input in the form in which the kernel is fastest."""
    return tuple(values.tolist()) if values.size <= LONGEST_IN_REGISTERS else values.copy()


def matrices(values: Floats, states: int) -> Floats:
    """Matrices (K, ., outputs) for a state of so many numbers in the form in which the kernel is fastest: for
    an array (K, ., blocks, 8), so that several outputs are summed at once.
    """
    if states <= LONGEST_IN_REGISTERS:
        return np.ascontiguousarray(values)
    count, inputs, outputs = values.shape
    blocks = -(-outputs // WIDTH)
    out = simd_empty(count, inputs, blocks, WIDTH)
    out[...] = 0.0
    out.reshape(count, inputs, blocks * WIDTH)[:, :, :outputs] = values
    return out


def put(target: Any, i: Any, value: Any) -> Any:
    """`target` with element `i` replaced; an array is changed in place."""


@overload(put)  # type: ignore[untyped-decorator]
def _put(target: Any, i: Any, value: Any) -> Any:
    if isinstance(target, types.Array):

        def in_place(target: Any, i: Any, value: Any) -> Any:
            target[i] = value
            return target

        return in_place

    def of_tuple(target: Any, i: Any, value: Any) -> Any:
        return tuple_setitem(target, i, value)

    return of_tuple


def moved(matrix: Any, k: Any, state: Any, held: Any, scratch: Any) -> Any:
    """`state` after the step with matrix `k`; an array is changed in place."""


@overload(moved, jit_options={"fastmath": FUSED})  # type: ignore[untyped-decorator]
def _moved(matrix: Any, k: Any, state: Any, held: Any, scratch: Any) -> Any:
    if isinstance(state, types.Array):

        def in_place(matrix: Any, k: Any, state: Any, held: Any, scratch: Any) -> Any:
            seen(matrix, k, state, held, scratch, 0, state)
            for i in range(state.size):
                state[i] = scratch[0, i]
            return state

        return in_place

    def of_tuple(matrix: Any, k: Any, state: Any, held: Any, scratch: Any) -> Any:
        result = state
        for i in range(len(state)):
            total = 0.0
            for j in range(len(state)):
                total += matrix[k, j, i] * state[j]
            for j in range(len(held)):
                total += matrix[k, len(state) + j, i] * held[j]
            result = tuple_setitem(result, i, total)
        return result

    return of_tuple


def seen(matrix: Any, k: Any, state: Any, held: Any, out: Any, row: Any, like: Any) -> Any:
    """Write what matrix `k` makes of [state, held] into a row of `out`, which is as long as `like`."""


@overload(seen, jit_options={"fastmath": FUSED})  # type: ignore[untyped-decorator]
def _seen(matrix: Any, k: Any, state: Any, held: Any, out: Any, row: Any, like: Any) -> Any:
    if isinstance(state, types.Array):

        def columns(matrix: Any, k: Any, state: Any, held: Any, out: Any, row: Any, like: Any) -> Any:
            size, outputs = len(state), len(like)
            for i in range(outputs):
                out[row, i] = matrix[k, 0, i] * state[0]
            for j in range(1, size):
                for i in range(outputs):
                    out[row, i] += matrix[k, j, i] * state[j]
            for j in range(len(held)):
                for i in range(outputs):
                    out[row, i] += matrix[k, size + j, i] * held[j]

        def blocks(matrix: Any, k: Any, state: Any, held: Any, out: Any, row: Any, like: Any) -> Any:
            size, outputs = len(state), len(like)
            for block in range(matrix.shape[2]):
                one = other = inputs = everywhere(0.0)  # side by side: a sum waits for the one before
                for j in range(0, size - 1, 2):
                    one += numbers(matrix, (k, j, block)) * state[j]
                    other += numbers(matrix, (k, j + 1, block)) * state[j + 1]
                if size % 2:
                    one += numbers(matrix, (k, size - 1, block)) * state[size - 1]
                for j in range(len(held)):
                    inputs += numbers(matrix, (k, size + j, block)) * held[j]
                begin = block * WIDTH
                put_first(out, (row, begin), (one + other) + inputs, outputs - begin)

        return blocks if matrix.ndim == 4 else columns

    def rows(matrix: Any, k: Any, state: Any, held: Any, out: Any, row: Any, like: Any) -> Any:
        for i in range(len(like)):
            total = 0.0
            for j in range(len(state)):
                total += matrix[k, j, i] * state[j]
            for j in range(len(held)):
                total += matrix[k, len(state) + j, i] * held[j]
            out[row, i] = total

    return rows
