"""The compiled kernel of linear loops: executes a program over step matrices.

A small state is a tuple of numbers, whose length is part of the type: the compiler writes its loops out and
keeps it in registers. A larger one is an array. Both take the same kernel.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba.core import types
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import overload

from rthm_core.compiled import FUSED, Floats, Integers, fused, inlined, plainly
from rthm_core.engine.worked import worked
from rthm_core.physical.sensors import Sensors, measured
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import numbers, put_numbers

LONGEST_IN_REGISTERS = 6
"""Longest state that is kept in registers."""

Vector = tuple[float, ...] | Floats
"""Numbers of a state or an input: a tuple up to the length `LONGEST_IN_REGISTERS`, else an array."""


def vector(values: Floats) -> Vector:
    """State or input in the form in which the kernel is fastest."""
    return tuple(values.tolist()) if values.size <= LONGEST_IN_REGISTERS else values.copy()


class Tables(NamedTuple):
    """Matrices of a program; each is transposed, with a row per element of [state, held inputs].

    Attributes
    ----------
    plant, numerical : (K, ., n) arrays
        Steps of both sides.
    sample, plant_row, numerical_row : (K, ., outputs) arrays
        What is seen a time after the last change of an input.
    reference : (., m) array
        F_d from [state, held] of the numerical side.
    """

    plant: Floats
    numerical: Floats
    sample: Floats
    plant_row: Floats
    numerical_row: Floats
    reference: Floats
    bias: Floats
    k_tot: Floats


class Operations(NamedTuple):
    """Program for the kernel; arrays (2, operations): row 0 is the first pass, row 1 every further one.

    `plant`, `numerical` and `work` say which of the matrices an operation takes, -1: none; where work is
    counted, both sides take a step, or none does.
    """

    what: Integers
    time: Integers
    plant: Integers
    numerical: Integers
    sample: Integers
    reference: Integers
    period: int
    work: Integers


class Memory(NamedTuple):
    """Samples and references that are still needed, newest at ``count - 1`` modulo the (power of two) length.

    Attributes
    ----------
    samples, references : (length, 2 m), (length, m) arrays
        What has been there before the test is written in advance.
    count : (3,) array
        Samples, references and rows so far.
    """

    samples: Floats
    references: Floats
    count: Integers  # type: ignore[assignment]


ROW_COUNT = 2
"""Place of the number of rows in ``Memory.count``."""


class Counting(NamedTuple):
    """Work: coefficients (K, pairs, 8) of the products of the joint state, and the sums so far (8,)."""

    tables: Floats
    sums: Floats
    joint: Floats


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

        return columns

    def rows(matrix: Any, k: Any, state: Any, held: Any, out: Any, row: Any, like: Any) -> Any:
        for i in range(len(like)):
            total = 0.0
            for j in range(len(state)):
                total += matrix[k, j, i] * state[j]
            for j in range(len(held)):
                total += matrix[k, len(state) + j, i] * held[j]
            out[row, i] = total

    return rows


@inlined
def _joined(joint: Floats, begin: int, part: Vector) -> int:
    """Write a part of the joint state from `begin` on; where the next begins."""
    for i in range(len(part)):
        joint[begin + i] = part[i]
    return begin + len(part)


@inlined
def _worked(
    tables: Floats, k: int, joint: Floats, plant: Vector, command: Vector, numerical: Vector, held: Vector
) -> Any:
    """Work (8,), a SIMD value, by table `k` from the joint state."""
    d = _joined(joint, _joined(joint, 0, plant), command)
    _joined(joint, _joined(joint, d, numerical), held)
    return worked(tables, k, joint)


@plainly
@fused
def run(
    tables: Tables,
    operations: Operations,
    memory: Memory,
    sensors: Sensors | None,
    counting: Counting | None,
    plant: Any,
    command: Any,
    numerical: Any,
    held: Any,
    passes: int,
    out: Any,
    like: Any,
) -> tuple[Any, Any, Any, Any]:
    """Execute a program `passes` times or until the rows `out` are full.

    With `counting`, both sides move at every change of an input, and the commands are in two parts.
    Returns the states and held inputs; samples, references and their number stay in `memory`.
    """
    plant_step, numerical_step, sample_row, plant_row, numerical_row, reference_row, bias, k_tot = tables
    what, time, plant_at, numerical_at, sample_back, reference_back, period, work_at = operations
    samples, references, count = memory
    plant_out, numerical_out, reference_out, work_out = out
    scratch1, scratch2 = np.empty((1, len(plant))), np.empty((1, len(numerical)))
    s_mask, r_mask = samples.shape[0] - 1, references.shape[0] - 1
    s, r, row = count[0], count[1], count[2]
    m = len(like[2])
    for p in range(passes):
        later = what.size if p > 0 else 0
        for e in range(what.size):
            kind = what[e]
            if kind == OUTPUT:
                seen(plant_row, plant_at[later + e], plant, command, plant_out, row, like[0])
                seen(numerical_row, numerical_at[later + e], numerical, held, numerical_out, row, like[1])
                for i in range(m):
                    reference_out[row, i] = references[(r - reference_back[e]) & r_mask, i]
                if counting is not None:
                    k = work_at[later + e]
                    added = _worked(counting.tables, k, counting.joint, plant, command, numerical, held)
                    put_numbers(work_out, (row,), numbers(counting.sums, ()) + added)
                row += 1
                if row == reference_out.shape[0]:
                    break
                continue
            if kind == SAMPLE:
                new = s & s_mask
                seen(sample_row, plant_at[later + e], plant, command, samples, new, held)
                for i in range(len(held)):
                    samples[new, i] += bias[i]
                    if sensors is not None:
                        stamp = time[e] + p * period
                        samples[new, i] = measured(sensors, i, samples[new, i], bias, stamp)
                s += 1
                continue
            used, asked = (s - sample_back[e]) & s_mask, (r - reference_back[e]) & r_mask
            step1, step2 = plant_at[later + e], numerical_at[later + e]
            if counting is not None and step1 >= 0:
                k = work_at[later + e]
                added = _worked(counting.tables, k, counting.joint, plant, command, numerical, held)
                put_numbers(counting.sums, (), numbers(counting.sums, ()) + added)
            if step1 >= 0:
                plant = moved(plant_step, step1, plant, command, scratch1)
            if step2 >= 0:
                numerical = moved(numerical_step, step2, numerical, held, scratch2)
            if kind == REFERENCE:
                for i in range(len(held)):
                    held = put(held, i, samples[used, i])
                seen(reference_row, 0, numerical, held, references, r & r_mask, like[2])
                r += 1
            elif kind == MOTOR:
                for i in range(m):
                    if counting is None:
                        command = put(command, i, samples[used, i] + references[asked, i] / k_tot[i])
                    else:
                        command = put(command, i, samples[used, i])
                        command = put(command, m + i, references[asked, i] / k_tot[i])
    count[0], count[1], count[2] = s, r, row
    return plant, command, numerical, held
