"""Kernels over several loops at once: the last axis of every array is the loop, `LANES` of them side by side.

All lanes execute the same program, so that one decision serves them all and arithmetic fills the registers.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import (
    Floats,
    Integers,
    compiled,
    compiled_in_place,
    inlined,
    inlined_allocating,
)
from rthm_core.engine.curved.steps import terms_of
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE

LANES = 128
"""How many loops run side by side; kernels take it from their arrays, since a short loop of fixed length is
written out before it could be put into wide registers."""

BUFFER = 32
"""Rows that are kept before they are written to each loop's own memory."""


class Lanes(NamedTuple):
    """Loops side by side.

    Attributes
    ----------
    a1, a2 : (n, n, LANES) arrays
        Dynamics of [state, held inputs] of the plant (inputs: commands) and of the numerical side (inputs:
        latched motion), 1/s.
    y1, y2 : (n, LANES) arrays
        Positions and velocities, then the held inputs, at the start.
    k_tot, stiffness, damping : (m, LANES) arrays
        Of the actuators and of the interface.
    dof1, dof2 : (m,) arrays
        Interface dofs of both sides.
    """

    a1: Floats
    a2: Floats
    y1: Floats
    y2: Floats
    k_tot: Floats
    stiffness: Floats
    damping: Floats
    dof1: Integers
    dof2: Integers


class Working(NamedTuple):
    """States and held inputs of both sides, 1 / k_tot, scratch, and rows that are not yet written."""

    y1: Floats
    y2: Floats
    compliance: Floats
    scratch: Floats
    buffer: Floats


def working(lanes: Lanes, columns: int) -> Working:
    """Start of loops side by side, for rows of so many columns."""
    longest = max(lanes.y1.shape[0], lanes.y2.shape[0])
    return Working(
        lanes.y1.copy(),
        lanes.y2.copy(),
        1.0 / lanes.k_tot,
        np.empty((1, longest, LANES)),
        np.empty((BUFFER, columns, LANES)),
    )


@inlined
def _product(a: Floats, b: Floats, out: Floats) -> None:
    """Matrix products of all lanes, added to `out`."""
    n = a.shape[0]
    for i in range(n):
        for j in range(n):
            for k in range(n):
                for lane in range(out.shape[2]):
                    out[i, j, lane] += a[i, k, lane] * b[k, j, lane]


@inlined_allocating
def _exponential(a: Floats, t: float, x: Floats, grown: Floats, work: Floats) -> None:
    """``exp(a t) - 1`` of all lanes into `grown`, by scaling and squaring of the series."""
    n = a.shape[0]
    largest = 0.0
    for i in range(n):
        for lane in range(a.shape[2]):
            total = 0.0
            for j in range(n):
                total += abs(a[i, j, lane])
            largest = max(largest, total * t)
    halvings = max(0, math.ceil(math.log2(2.0 * largest))) if largest > 0.5 else 0
    x[:] = a * (t * 0.5**halvings)
    terms = terms_of(largest * 0.5**halvings)
    grown[:] = x / terms
    for k in range(terms - 1, 0, -1):
        work[:] = x
        _product(x, grown, work)
        grown[:] = work / k
    for _ in range(halvings):
        work[:] = 2.0 * grown
        _product(grown, grown, work)
        grown[:] = work


@compiled
def lane_steps(a: Floats, lengths: Floats, states: int) -> Floats:
    """Step matrices (K, n, states, LANES), transposed, over each of the lengths (s)."""
    n = a.shape[0]
    steps = np.empty((lengths.size, n, states, LANES))
    x, grown, work = np.empty_like(a), np.empty_like(a), np.empty_like(a)
    for k in range(lengths.size):
        _exponential(a, lengths[k], x, grown, work)
        for i in range(states):
            for j in range(n):
                for lane in range(a.shape[2]):
                    steps[k, j, i, lane] = grown[i, j, lane] + (1.0 if i == j else 0.0)
    return steps


@inlined
def _looked(steps: Floats, k: int, y: Floats, out: Floats, row: int, first: int, made: Any, of: Any) -> None:
    """What step `k` makes of `y`, into ``out[row, first:]``.

    `made` and `of` are as long as the result and as `y`.
    """
    for i in range(len(made)):
        for lane in range(y.shape[1]):
            total = 0.0
            for j in range(len(of)):
                total += steps[k, j, i, lane] * y[j, lane]
            out[row, first + i, lane] = total


@inlined
def _moved(steps: Floats, k: int, y: Floats, scratch: Floats, made: Any, of: Any) -> None:
    """Let all lanes take step `k`."""
    _looked(steps, k, y, scratch, 0, 0, made, of)
    for i in range(len(made)):
        for lane in range(y.shape[1]):
            y[i, lane] = scratch[0, i, lane]


@inlined
def _force(lanes: Lanes, y2: Floats, out: Floats, row: int) -> None:
    """F_d between the held and the present motion of the numerical side."""
    m = lanes.dof2.size
    n2 = y2.shape[0] - 2 * m
    for i in range(m):
        x, v = lanes.dof2[i], n2 // 2 + lanes.dof2[i]
        for lane in range(y2.shape[1]):
            damper = lanes.damping[i, lane] * (y2[n2 + m + i, lane] - y2[v, lane])
            spring = lanes.stiffness[i, lane] * (y2[n2 + i, lane] - y2[x, lane])
            out[row, i, lane] = -damper - spring


@inlined
def _unload(buffer: Floats, rows: int, out: Floats, first: int) -> None:
    """Write a few rows of all lanes to where each loop has its own."""
    for lane in range(out.shape[0]):
        for row in range(rows):
            for i in range(out.shape[2]):
                out[lane, first + row, i] = buffer[row, i, lane]


@compiled_in_place
def run_lanes(
    lanes: Lanes,
    steps: tuple[Floats, Floats, Floats],
    operations: Integers,
    samples: Floats,
    references: Floats,
    passes: int,
    out: Floats,
    like: Any,
    work: Working,
) -> None:
    """Execute a program on all lanes.

    Parameters
    ----------
    lanes : Lanes
        The loops.
    steps : (K, ., ., LANES) arrays
        Steps of the plant, of its motion at the interface, and of the numerical side.
    operations : (5, 2, operations) array
        What, step of the plant's and of the numerical side, distances of sample and reference; for the first
        and for every further pass.
    samples, references : (length, ., LANES) arrays
        Memory, filled with what has been there before the test.
    passes : int
        How often the program is executed, unless `out` is full before.
    out : (lanes, N, n1 + n2 + 2 m) array
        Motion of the plant, motion of the numerical side, F_d in use, wire force.
    like : tuple
        Vectors as long as the states and all that moves them, of both sides, and as the actuators.
    work : Working
        What is changed on the way.
    """
    y1, y2, compliance, scratch, buffer = work
    made1, of1, made2, of2, actuators, latched = like
    n1, n2, m = len(made1), len(made2), len(actuators)
    s_mask, r_mask = samples.shape[0] - 1, references.shape[0] - 1
    s, r, row, unloaded = 0, 0, 0, 0
    for p in range(passes):
        later = min(p, 1)
        for e in range(operations.shape[2]):
            what = operations[0, later, e]
            k1, k2 = operations[1, later, e], operations[2, later, e]
            used, asked = (s - operations[3, later, e]) & s_mask, (r - operations[4, later, e]) & r_mask
            if what == SAMPLE:
                _looked(steps[1], k1, y1, samples, s & s_mask, 0, latched, of1)
                s += 1
            elif what == MOTOR:
                _moved(steps[0], k1, y1, scratch, made1, of1)
                for i in range(m):
                    for lane in range(y1.shape[1]):
                        feedforward = references[asked, i, lane] * compliance[i, lane]
                        y1[n1 + i, lane] = samples[used, i, lane] + feedforward
            elif what == REFERENCE:
                _moved(steps[2], k2, y2, scratch, made2, of2)
                for i in range(2 * m):
                    for lane in range(y1.shape[1]):
                        y2[n2 + i, lane] = samples[used, i, lane]
                _force(lanes, y2, references, r & r_mask)
                r += 1
            elif what == OUTPUT and row < out.shape[1]:
                at = row - unloaded
                _looked(steps[0], k1, y1, buffer, at, 0, made1, of1)
                _looked(steps[2], k2, y2, buffer, at, n1, made2, of2)
                for i in range(m):
                    for lane in range(y1.shape[1]):
                        buffer[at, n1 + n2 + i, lane] = references[asked, i, lane]
                        stretch = y1[n1 + i, lane] - buffer[at, lanes.dof1[i], lane]
                        buffer[at, n1 + n2 + m + i, lane] = lanes.k_tot[i, lane] * stretch
                row += 1
                if at + 1 == BUFFER or row == out.shape[1]:
                    _unload(buffer, at + 1, out, unloaded)
                    unloaded = row
