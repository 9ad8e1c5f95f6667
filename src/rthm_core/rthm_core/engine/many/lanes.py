"""Kernels over several loops at once: the last two axes of every array are the loops, `GROUPS` times `WIDTH`.

All of them execute the same program, so that one decision serves them all and arithmetic is done in SIMD
registers.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba.core import types
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import overload

from rthm_core.compiled import Floats, Integers, compiled, compiled_in_place, inlined
from rthm_core.engine.nonlinear.steps import terms_of
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import WIDTH, everywhere, numbers, put_numbers, several, simd_empty

GROUPS = 8
"""How many groups execute an operation one after the other; what they need stays in the nearest memory."""

LANES = GROUPS * WIDTH
"""How many loops run side by side."""

BUFFER = 32
"""Rows that are kept before they are written to each loop's own memory."""


class Lanes(NamedTuple):
    """Loops side by side.

    Attributes
    ----------
    a1, a2 : (n, n, Q, 8) arrays
        Dynamics of [state, held inputs] of the plant (inputs: commands) and of the numerical side (inputs:
        latched motion), 1/s.
    y1, y2 : (n, Q, 8) arrays
        Positions and velocities, then the held inputs: at the start, and moved on from there.
    k_tot, compliance, stiffness, damping : (m, Q, 8) arrays
        Of the actuators, its inverse, and of the interface.
    """

    a1: Floats
    a2: Floats
    y1: Floats
    y2: Floats
    k_tot: Floats
    compliance: Floats
    stiffness: Floats
    damping: Floats


class Scratch(NamedTuple):
    """Memory of samples (length, 2 m, Q, 8) and references (length, m, Q, 8), their lengths powers of two;
    a state that is being made (1, ., Q, 8), and rows that are not yet written.
    """

    samples: Floats
    references: Floats
    moved: Floats
    buffer: Floats


def scratch(samples: int, references: int, m: int, columns: int) -> Scratch:
    """Memory that reaches back so many samples and references, for rows of so many columns."""
    lengths = [1 << (reach + 1).bit_length() for reach in (samples, references)]
    return Scratch(
        simd_empty(lengths[0], 2 * m, GROUPS, WIDTH),
        simd_empty(lengths[1], m, GROUPS, WIDTH),
        simd_empty(1, columns, GROUPS, WIDTH),
        simd_empty(BUFFER, columns, GROUPS, WIDTH),
    )


@inlined
def _product(start: Floats, factor: float, a: Floats, b: Floats, out: Floats) -> None:
    """Let `out` be ``factor start + a b``; all are (n, n, 8), and `out` is none of the others."""
    n = a.shape[0]
    for i in range(n):
        for j in range(n):
            total = numbers(start, (i, j)) * factor
            for k in range(n):
                total += numbers(a, (i, k)) * numbers(b, (k, j))
            put_numbers(out, (i, j), total)


@inlined
def _scaled(a: Floats, factor: float, out: Floats) -> None:
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            put_numbers(out, (i, j), numbers(a, (i, j)) * factor)


@inlined
def _largest(a: Floats) -> float:
    """Largest row sum of matrices (n, n, 8)."""
    largest = 0.0
    for i in range(a.shape[0]):
        for lane in range(a.shape[2]):
            total = 0.0
            for j in range(a.shape[1]):
                total += abs(a[i, j, lane])
            largest = max(largest, total)
    return largest


@inlined
def _exponential(a: Floats, t: float, x: Floats, grown: Floats, work: Floats) -> None:
    """``exp(a t) - 1`` of matrices (n, n, 8) into `grown`, by scaling and squaring of the series."""
    largest = _largest(a) * t
    halvings = max(0, math.ceil(math.log2(2.0 * largest))) if largest > 0.5 else 0
    terms = terms_of(largest * 0.5**halvings)
    _scaled(a, t * 0.5**halvings, x)
    _scaled(x, 1.0 / terms, grown)
    for k in range(terms - 1, 0, -1):
        _product(x, 1.0, x, grown, work)
        _scaled(work, 1.0 / k, grown)
    for _ in range(halvings):
        _product(grown, 2.0, grown, grown, work)
        _scaled(work, 1.0, grown)


def lane_steps(a: Floats, lengths: Floats, states: int) -> Floats:
    """Step matrices (K, n, states, Q, 8), transposed, over each of the lengths (s)."""
    steps = simd_empty(lengths.size, a.shape[0], states, a.shape[2], WIDTH)
    _fill_steps(a, lengths, steps)
    return steps


@compiled
def _fill_steps(a: Floats, lengths: Floats, steps: Floats) -> None:
    n, states, groups = steps.shape[1:4]
    own, x, grown, work = (
        np.empty((n, n, WIDTH)),
        np.empty((n, n, WIDTH)),
        np.empty((n, n, WIDTH)),
        np.empty((n, n, WIDTH)),
    )
    for group in range(groups):
        for i in range(n):
            for j in range(n):
                put_numbers(own, (i, j), numbers(a, (i, j, group)))
        for k in range(lengths.size):
            _exponential(own, lengths[k], x, grown, work)
            for i in range(states):
                for j in range(n):
                    same = 1.0 if i == j else 0.0
                    put_numbers(steps, (k, j, i, group), numbers(grown, (i, j)) + same)


@inlined
def _looked(steps: Floats, k: int, y: Floats, out: Floats, row: int, first: int, made: Any, of: Any) -> None:
    """What step `k` makes of `y`, into ``out[row, first:]``.

    `made` and `of` are as long as the result and as `y`.
    """
    for group in range(y.shape[1]):
        for i in range(len(made)):
            total = everywhere(0.0)
            for j in range(len(of)):
                total += numbers(steps, (k, j, i, group)) * numbers(y, (j, group))
            put_numbers(out, (row, first + i, group), total)


def _moved(steps: Floats, k: int, y: Floats, moved: Floats, made: Any, of: Any) -> None:
    """Let all lanes take step `k`; `moved` is scratch."""


@overload(_moved)  # type: ignore[untyped-decorator]
def _moved_compiled(steps: Any, k: Any, y: Any, moved: Any, made: Any, of: Any) -> Any:
    if isinstance(made, types.Array):

        def by_scratch(steps: Any, k: Any, y: Any, moved: Any, made: Any, of: Any) -> None:
            _looked(steps, k, y, moved, 0, 0, made, of)
            for i in range(len(made)):
                for group in range(y.shape[1]):
                    put_numbers(y, (i, group), numbers(moved, (0, i, group)))

        return by_scratch

    def in_registers(steps: Any, k: Any, y: Any, moved: Any, made: Any, of: Any) -> None:
        for group in range(y.shape[1]):
            result = several(made)
            for i in range(len(made)):
                total = everywhere(0.0)
                for j in range(len(of)):
                    total += numbers(steps, (k, j, i, group)) * numbers(y, (j, group))
                result = tuple_setitem(result, i, total)
            for i in range(len(made)):
                put_numbers(y, (i, group), result[i])

    return in_registers


@inlined
def _force(lanes: Lanes, dofs: Integers, out: Floats, row: int) -> None:
    """F_d between the held and the present motion of the numerical side."""
    y, m = lanes.y2, dofs.size
    n = y.shape[0] - 2 * m
    for i in range(m):
        x, v = dofs[i], n // 2 + dofs[i]
        for group in range(y.shape[1]):
            slip = numbers(y, (v, group)) - numbers(y, (n + m + i, group))
            stretch = numbers(y, (x, group)) - numbers(y, (n + i, group))
            damper = numbers(lanes.damping, (i, group)) * slip
            put_numbers(out, (row, i, group), damper + numbers(lanes.stiffness, (i, group)) * stretch)


@inlined
def _latched(samples: Floats, row: int, y: Floats, first: int) -> None:
    """Let a sample be what the numerical side holds."""
    for i in range(samples.shape[1]):
        for group in range(y.shape[1]):
            put_numbers(y, (first + i, group), numbers(samples, (row, i, group)))


@inlined
def _command(lanes: Lanes, samples: Floats, used: int, references: Floats, asked: int, first: int) -> None:
    """Let the position cancellation and the feedforward of a force be what the plant is pulled by."""
    for i in range(references.shape[1]):
        for group in range(lanes.y1.shape[1]):
            feedforward = numbers(references, (asked, i, group)) * numbers(lanes.compliance, (i, group))
            put_numbers(lanes.y1, (first + i, group), numbers(samples, (used, i, group)) + feedforward)


@inlined
def _forces(lanes: Lanes, dofs: Integers, references: Floats, asked: int, out: Floats, row: int) -> None:
    """Write the last 2 m columns of a row: F_d in use and the force in the wire."""
    m = dofs.size
    first, command = out.shape[1] - 2 * m, lanes.y1.shape[0] - m
    for i in range(m):
        for group in range(lanes.y1.shape[1]):
            put_numbers(out, (row, first + i, group), numbers(references, (asked, i, group)))
            stretch = numbers(lanes.y1, (command + i, group)) - numbers(out, (row, dofs[i], group))
            put_numbers(out, (row, first + m + i, group), numbers(lanes.k_tot, (i, group)) * stretch)


@inlined
def _before(lanes: Lanes, dofs: Integers, samples: Floats, references: Floats) -> None:
    """Fill the memory with what has been there before the test: the motion at rest with its start."""
    first = lanes.y2.shape[0] - samples.shape[1]
    for row in range(samples.shape[0]):
        for i in range(samples.shape[1]):
            for group in range(lanes.y2.shape[1]):
                put_numbers(samples, (row, i, group), numbers(lanes.y2, (first + i, group)))
    for row in range(references.shape[0]):
        _force(lanes, dofs, references, row)


@inlined
def _unload(buffer: Floats, rows: int, out: Floats, first: int) -> None:
    """Write a few rows of all lanes to where each loop has its own."""
    for loop in range(out.shape[0]):
        for row in range(rows):
            for i in range(out.shape[2]):
                out[loop, first + row, i] = buffer[row, i, loop // WIDTH, loop % WIDTH]


@compiled_in_place
def run_lanes(
    lanes: Lanes,
    dofs: tuple[Integers, Integers],
    steps: tuple[Floats, Floats, Floats],
    operations: Any,
    passes: int,
    out: Any,
    like: Any,
    scratch: Scratch,
) -> None:
    """Execute a program on all lanes, whose states are moved.

    Parameters
    ----------
    lanes : Lanes
        The loops.
    dofs : (m,) arrays
        Interface dofs of the plant and of the numerical side.
    steps : (K, ., ., Q, 8) arrays
        Steps of the plant, of its motion at the interface, and of the numerical side.
    operations : (2, operations, 5) array of int32
        What, step of the plant's and of the numerical side, distances of sample and reference; for the first
        and for every further pass. Narrow, since a long program leaves less of the nearest memory to the
        steps.
    passes : int
        How often the program is executed, unless `out` is full before.
    out : (lanes, N, n1 + n2 + 2 m) array
        Motion of the plant, motion of the numerical side, F_d in use, wire force.
    like : tuple
        Vectors as long as the states and all that moves them, of both sides, and as a sample.
    scratch : Scratch
    """
    samples, references, moved, buffer = scratch
    made1, of1, made2, of2, latched = like
    n1, n2 = len(made1), len(made2)
    s_mask, r_mask = samples.shape[0] - 1, references.shape[0] - 1
    s, r, row, unloaded = 0, 0, 0, 0
    _before(lanes, dofs[1], samples, references)
    for p in range(passes):
        later = min(p, 1)
        for e in range(operations.shape[1]):
            what, k1, k2 = operations[later, e, 0], operations[later, e, 1], operations[later, e, 2]
            used = (s - operations[later, e, 3]) & s_mask
            asked = (r - operations[later, e, 4]) & r_mask
            if what == SAMPLE:
                _looked(steps[1], k1, lanes.y1, samples, s & s_mask, 0, latched, of1)
                s += 1
            elif what == MOTOR:
                _moved(steps[0], k1, lanes.y1, moved, made1, of1)
                _command(lanes, samples, used, references, asked, n1)
            elif what == REFERENCE:
                _moved(steps[2], k2, lanes.y2, moved, made2, of2)
                _latched(samples, used, lanes.y2, n2)
                _force(lanes, dofs[1], references, r & r_mask)
                r += 1
            elif what == OUTPUT and row < out.shape[1]:
                at = row - unloaded
                _looked(steps[0], k1, lanes.y1, buffer, at, 0, made1, of1)
                _looked(steps[2], k2, lanes.y2, buffer, at, n1, made2, of2)
                _forces(lanes, dofs[0], references, asked, buffer, at)
                row += 1
                if at + 1 == BUFFER or row == out.shape[1]:
                    _unload(buffer, at + 1, out, unloaded)
                    unloaded = row
