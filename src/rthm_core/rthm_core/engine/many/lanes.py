"""The kernel of several loops at once: the last axis of every array are eight loops, and each line of
arithmetic is done for all of them in SIMD registers.

All of them execute the same program, so that one decision serves them all. Eight go through all of it, then
the next eight: what they need stays in registers and the nearest memory.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, compiled_in_place, written_out
from rthm_core.engine.many.lane_steps import fill_steps
from rthm_core.engine.many.states import laid, moved, put, seen, state_of, taken
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import WIDTH, element, numbers, numbers_from, put_numbers, put_numbers_from, simd_empty

BUFFER = 32
"""Rows that are kept before they are written to each loop's own memory."""


class Lanes(NamedTuple):
    """Groups of loops side by side.

    Attributes
    ----------
    a1, a2 : (Q, states, n, 8) arrays
        Rates of the states by [state, held inputs] of the plant (inputs: commands) and of the numerical side
        (inputs: latched motion), 1/s.
    y1, y2 : (Q, 8 n) arrays
        Positions and velocities, then the held inputs, at the start; changed where they are long.
    k_tot, compliance, stiffness, damping : (Q, 8 m) arrays
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


class Room(NamedTuple):
    """Memory for one group: all that a program needs often lies in one array.

    Attributes
    ----------
    memory : (.,) array
    steps1, steps2 : (K, n, states, 8) arrays
        Parts of it: steps of the plant and of the numerical side.
    samples, references, state : int
        Where samples, references, and scratch for a state begin in it.
    work1, work2 : (3, states, n, 8) arrays
        Scratch for what makes the steps.
    buffer : (BUFFER, columns, 8) array
        Rows that are not yet written.
    """

    memory: Floats
    steps1: Floats
    steps2: Floats
    samples: int
    references: int
    state: int
    work1: Floats
    work2: Floats
    buffer: Floats


def room(steps: tuple[tuple[int, ...], tuple[int, ...]], samples: int, references: int, m: int) -> Room:
    """Room for `steps` of such shapes (K, n, states), and for so many samples and references."""
    sizes = [math.prod(steps[0]), math.prod(steps[1]), 2 * m * samples, m * references]
    ends = np.cumsum([*sizes, max(steps[0][1], steps[1][1])]) * WIDTH
    memory = simd_empty(int(ends[-1]))
    steps1, steps2 = memory[: ends[0]], memory[ends[0] : ends[1]]
    work1, work2 = (simd_empty(3, states, n, WIDTH) for _, n, states in steps)
    columns = steps[0][2] + steps[1][2] + 2 * m
    return Room(
        memory,
        steps1.reshape(*steps[0], WIDTH),
        steps2.reshape(*steps[1], WIDTH),
        int(ends[1]),
        int(ends[2]),
        int(ends[3]),
        work1,
        work2,
        simd_empty(BUFFER, columns, WIDTH),
    )


@written_out
def _force(stiffness, damping, dofs, y, at, n, memory, to):  # type: ignore[no-untyped-def]
    """F_d between the held and the present motion, which is in y from place `at` on and has `n` elements."""
    m = len(stiffness)
    for i in range(m):
        x, held = at + dofs[i] * WIDTH, at + (n + i) * WIDTH
        slip = numbers_from(y, x + n // 2 * WIDTH) - numbers_from(y, held + m * WIDTH)
        stretch = numbers_from(y, x) - numbers_from(y, held)
        force = taken(damping, i) * slip + taken(stiffness, i) * stretch
        put_numbers_from(memory, to + i * WIDTH, force)


@written_out
def _write(k_tot, dofs, plant, n, memory, asked, out, row):  # type: ignore[no-untyped-def]
    """Write the last 2 m columns of a row: F_d in use and the force in the wire."""
    m = len(k_tot)
    first = out.shape[1] - 2 * m
    for i in range(m):
        put_numbers(out, (row, first + i), numbers_from(memory, asked + i * WIDTH))
        stretch = taken(plant, n + i) - numbers(out, (row, dofs[i]))
        put_numbers(out, (row, first + m + i), taken(k_tot, i) * stretch)


@written_out
def _unload(buffer, rows, out, begin, first):  # type: ignore[no-untyped-def]
    """Write a few rows of the loops from `begin` on to where each has its own."""
    for lane in range(min(WIDTH, out.shape[0] - begin)):
        for row in range(rows):
            for i in range(out.shape[2]):
                out[begin + lane, first + row, i] = buffer[row, i, lane]


@written_out
def _of(operations, at, which):  # type: ignore[no-untyped-def]
    """One of the numbers of an operation."""
    return np.int64(element(operations, (at + which,)))


@compiled_in_place
def run_lanes(
    lanes: Lanes,
    dofs: tuple[Integers, Integers],
    lengths: tuple[Floats, Floats],
    operations: Any,
    passes: int,
    out: Any,
    like: Any,
    room: Room,
) -> None:
    """Execute a program on all loops.

    Parameters
    ----------
    lanes : Lanes
        The loops; those beyond `out` are not written.
    dofs : (m,) arrays
        Interface dofs of the plant and of the numerical side.
    lengths : (K,) arrays
        Of the steps of both, in s.
    operations : (2 operations 5,) array of int32
        What, and the places in the memory of the step of the plant's and of the numerical side (of a sample:
        whether its velocity is asked for), of the sample and of the reference that are used or made; for the
        first and then for every further pass. Narrow, since a long program leaves less of the nearest memory
        to the steps.
    passes : int
        How often the program is executed, unless `out` is full before.
    out : (loops, N, n1 + n2 + 2 m) array
        Motion of the plant, motion of the numerical side, F_d in use, wire force.
    like : tuple
        Vectors as long as the states of a side and as all of it, of both sides, and as there are actuators.
        The compiler knows lengths of tuples, and so where everything lies.
    room : Room
    """
    made1, of1, made2, of2, each = like
    memory, buffer, n1, n2, m, size = room.memory, room.buffer, len(made1), len(made2), len(each), 5
    once = operations.size // 2
    for group in range(lanes.y1.shape[0]):
        fill_steps(lanes.a1[group], lengths[0], room.steps1, room.work1)
        fill_steps(lanes.a2[group], lengths[1], room.steps2, room.work2)
        plant, numerical = state_of(lanes.y1[group], of1), state_of(lanes.y2[group], of2)
        k_tot, compliance = state_of(lanes.k_tot[group], each), state_of(lanes.compliance[group], each)
        stiffness, damping = state_of(lanes.stiffness[group], each), state_of(lanes.damping[group], each)
        for to in range(room.samples, room.references, 2 * m * WIDTH):  # at rest before the test
            for i in range(2 * m):
                put_numbers_from(memory, to + i * WIDTH, taken(numerical, n2 + i))
        for to in range(room.references, room.state, m * WIDTH):
            _force(stiffness, damping, dofs[1], lanes.y2[group], 0, n2, memory, to)
        row, unloaded = 0, 0
        for p in range(passes):
            begin = min(p, 1) * once
            for e in range(begin, begin + once, size):
                what, step = _of(operations, e, 0), _of(operations, e, 1)
                if what == SAMPLE:
                    to, whole = _of(operations, e, 3), _of(operations, e, 2)
                    for i in range(m):
                        x = dofs[0][i]
                        put_numbers_from(memory, to + i * WIDTH, seen(memory, step, x, plant, made1, of1))
                        if whole:
                            v, to_v = n1 // 2 + x, to + (m + i) * WIDTH
                            put_numbers_from(memory, to_v, seen(memory, step, v, plant, made1, of1))
                elif what == MOTOR:
                    plant = moved(memory, step, plant, made1, of1, room.state)
                    used, asked = _of(operations, e, 3), _of(operations, e, 4)
                    for i in range(m):
                        feedforward = numbers_from(memory, asked + i * WIDTH) * taken(compliance, i)
                        plant = put(plant, n1 + i, numbers_from(memory, used + i * WIDTH) + feedforward)
                elif what == REFERENCE:
                    step, used = _of(operations, e, 2), _of(operations, e, 3)
                    numerical = moved(memory, step, numerical, made2, of2, room.state)
                    for i in range(2 * m):
                        numerical = put(numerical, n2 + i, numbers_from(memory, used + i * WIDTH))
                    y, at = laid(numerical, memory, room.state)
                    _force(stiffness, damping, dofs[1], y, at, n2, memory, _of(operations, e, 4))
                elif row < out.shape[1] and what == OUTPUT:
                    at = row - unloaded
                    for i in range(n1):
                        put_numbers(buffer, (at, i), seen(memory, step, i, plant, made1, of1))
                    for i in range(n2):
                        other = seen(memory, _of(operations, e, 2), i, numerical, made2, of2)
                        put_numbers(buffer, (at, n1 + i), other)
                    _write(k_tot, dofs[0], plant, n1, memory, _of(operations, e, 4), buffer, at)
                    row += 1
                    if at + 1 == BUFFER or row == out.shape[1]:
                        _unload(buffer, at + 1, out, group * WIDTH, unloaded)
                        unloaded = row
