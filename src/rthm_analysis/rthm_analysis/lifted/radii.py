"""Eigenvalues of many loops that share a pattern of events, in one compiled pass.

The loops may differ in everything but their sizes: masses, stiffnesses, motors, effects, and the unit of time
(`Cycle.scaled`), so that all periods and delays grow together.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rthm_analysis.lifted.compiled import compiled, inlined, inlined_allocating
from rthm_analysis.lifted.cycle import Cycle
from rthm_analysis.lifted.eigen import write_moduli
from rthm_analysis.lifted.matrices import LinearLoop
from rthm_analysis.lifted.walk import Columns, Forcing, Plan, walk
from rthm_core.compiled import Floats, Integers


class Stack(NamedTuple):
    """Matrices of N loops (see `LinearLoop`), with the loop as first axis."""

    a1: Floats
    b1: Floats
    sampled: Floats
    a2: Floats
    b2: Floats
    force_held: Floats
    force_state: Floats
    flexibility: Floats


def stacked(loops: Sequence[LinearLoop]) -> Stack:
    """Lay loops of equal sizes out for compiled code."""
    return Stack(*(np.stack([getattr(one, name) for one in loops]) for name in Stack._fields))


def spectral_radii(loops: Stack, cycle: Cycle, units: Floats | None = None) -> Floats:
    """Largest modulus (N,) of each loop's eigenvalues over one hyperperiod (see `moduli`)."""
    return np.asarray(moduli(loops, cycle, units).max(axis=1))


def moduli(loops: Stack, cycle: Cycle, units: Floats | None = None) -> Floats:
    """Moduli (N, size) of the eigenvalues of every loop over one hyperperiod, in no order; for controllers
    that do not predict.

    Parameters
    ----------
    loops : Stack
        N linear loops.
    cycle : Cycle
        What happens in a hyperperiod, the same for all.
    units : (N,) array, optional
        Unit of the cycle's times for every loop, s; that of the cycle when absent.
    """
    count = loops.a1.shape[0]
    units = np.full(count, cycle.unit) if units is None else np.asarray(units, dtype=float)
    pattern = (cycle.what, cycle.place, *cycle.advance, *cycle.intervals, cycle.kept)
    m = loops.flexibility.shape[1]
    rows = loops.a1.shape[1] + loops.a2.shape[1] + m * (cycle.kept.size + cycle.motor_held)
    out = np.empty((count, rows))
    _moduli(loops, *pattern, cycle.places, int(cycle.motor_held), units, out)
    return out


@inlined_allocating
def _fill_step(a, b, dt, step):  # type: ignore[no-untyped-def]
    """``[Phi, Gamma]`` (n, n + q) of a step of `dt`: a short Taylor series, then doubled."""
    n, q = a.shape[0], b.shape[1]
    norm = 0.0
    for i in range(n):
        row = 0.0
        for j in range(n):
            row += abs(a[i, j])
        norm = max(norm, row * dt)
    doublings = 0
    while norm > 0.5:
        norm *= 0.5
        doublings += 1
    h = dt / 2.0**doublings
    term, fresh = np.zeros((n, n + q)), np.zeros((n, n + q))
    for i in range(n):
        for j in range(n):
            term[i, j] = a[i, j] * h
        for j in range(q):
            term[i, n + j] = b[i, j] * h
    for i in range(n):
        for j in range(n + q):
            step[i, j] = term[i, j] + (1.0 if i == j else 0.0)
    size, k = 1.0, 2
    while size > 1e-18 and k < 20:
        for i in range(n):
            for j in range(n + q):
                total = 0.0
                for c in range(n):
                    total += a[i, c] * term[c, j]
                fresh[i, j] = total * h / k
        for i in range(n):
            for j in range(n + q):
                term[i, j] = fresh[i, j]
                step[i, j] += fresh[i, j]
        size *= norm / k
        k += 1
    for _ in range(doublings):
        for i in range(n):
            for j in range(n + q):
                total = step[i, j] if j >= n else 0.0
                for c in range(n):
                    total += step[i, c] * step[c, j]
                fresh[i, j] = total
        for i in range(n):
            for j in range(n + q):
                step[i, j] = fresh[i, j]


@inlined
def _unit_states(columns, kept, motor_held):  # type: ignore[no-untyped-def]
    """One column for each row of the lifted state."""
    n1, n2, m = columns.p.shape[0], columns.z.shape[0], columns.u.shape[0]
    columns.p[:], columns.z[:], columns.u[:], columns.held[:] = 0.0, 0.0, 0.0, 0.0
    columns.store[: kept.size] = 0.0
    for i in range(n1):
        columns.p[i, i] = 1.0
    for i in range(n2):
        columns.z[i, n1 + i] = 1.0
    at = n1 + n2
    for i in range(m * motor_held):
        columns.u[i, at + i] = 1.0
    at += m * motor_held
    for k in range(kept.size):
        for i in range(m):
            columns.store[k, i, at + k * m + i] = 1.0


@inlined
def _lifted_rows(columns, kept, motor_held, matrix):  # type: ignore[no-untyped-def]
    n1, n2, m = columns.p.shape[0], columns.z.shape[0], columns.u.shape[0]
    for c in range(matrix.shape[0]):
        for i in range(n1):
            matrix[i, c] = columns.p[i, c]
        for i in range(n2):
            matrix[n1 + i, c] = columns.z[i, c]
        at = n1 + n2
        for i in range(m * motor_held):
            matrix[at + i, c] = columns.u[i, c]
        at += m * motor_held
        for k in range(kept.size):
            for i in range(m):
                matrix[at + k * m + i, c] = columns.store[kept[k], i, c]


@compiled
def _moduli(
    loops: Stack,
    what: Integers,
    place: Integers,
    advance1: Integers,
    advance2: Integers,
    intervals1: Integers,
    intervals2: Integers,
    kept: Integers,
    places: int,
    motor_held: int,
    units: Floats,
    out: Floats,
) -> None:
    n1, n2, m = loops.a1.shape[1], loops.a2.shape[1], loops.flexibility.shape[1]
    size = out.shape[1]
    columns = Columns(
        np.zeros((n1, size)),
        np.zeros((n2, size)),
        np.zeros((m, size)),
        np.zeros((2 * m, size)),
        np.zeros((places, m, size)),
        np.zeros((max(n1, n2), size)),
    )
    nothing = Forcing(np.zeros((0, 2 * m, size)), np.zeros((0, m, size)), np.zeros((0, 2 * m, size)))
    steps1 = np.zeros((intervals1.size, n1, n1 + m))
    steps2 = np.zeros((intervals2.size, n2, n2 + 2 * m))
    no_past, no_weights = np.zeros((0, 3, 0), dtype=np.int64), np.zeros((0, 3, 0, m))
    matrix = np.zeros((size, size))
    for loop in range(out.shape[0]):
        for k in range(intervals1.size):
            _fill_step(loops.a1[loop], loops.b1[loop], intervals1[k] * units[loop], steps1[k])
        for k in range(intervals2.size):
            _fill_step(loops.a2[loop], loops.b2[loop], intervals2[k] * units[loop], steps2[k])
        plan = Plan(
            what,
            place,
            advance1,
            advance2,
            steps1,
            steps2,
            loops.sampled[loop],
            loops.force_held[loop],
            loops.force_state[loop],
            loops.flexibility[loop],
            no_past,
            no_weights,
        )
        _unit_states(columns, kept, motor_held)
        walk(plan, columns, nothing)
        _lifted_rows(columns, kept, motor_held, matrix)
        write_moduli(matrix, out[loop])
