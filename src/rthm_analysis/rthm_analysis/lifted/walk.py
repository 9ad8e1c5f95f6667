"""The pass over one cycle: what becomes of any number of states of a loop at once, one in each column."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.lifted.compiled import compiled, inlined
from rthm_analysis.lifted.cycle import NOWHERE, Cycle
from rthm_analysis.lifted.matrices import LinearLoop
from rthm_core.compiled import Floats, Integers
from rthm_core.schedule import COMMAND, REFERENCE, SAMPLE


class Plan(NamedTuple):
    """A cycle and the matrices of a loop, as compiled code needs them."""

    what: Integers
    place: Integers
    advance1: Integers
    advance2: Integers
    steps1: Floats
    steps2: Floats
    sampled: Floats
    force_held: Floats
    force_state: Floats
    flexibility: Floats
    past: Integers
    weights: Floats


class Columns(NamedTuple):
    """States of a loop, one in each of L columns (real or complex); changed in place.

    `p` (np, L) and `z` (2 n2, L) move, `u` (m, L) and `held` (2 m, L) are the inputs in force, and `store`
    (places, m, L) is what is remembered.
    """

    p: Floats
    z: Floats
    u: Floats
    held: Floats
    store: Floats


class Forcing(NamedTuple):
    """What loads add to what is sampled (E, 2 m, L) and to the references (E, m, L), event by event.

    `trace` (E, 2 m, L) receives the input of the motors after each MOTOR and the held motion after each
    REFERENCE. Without rows there is no forcing, and no trace.
    """

    sample: Floats
    reference: Floats
    trace: Floats


def plan(loop: LinearLoop, cycle: Cycle, steps1: Floats, steps2: Floats, weights: Floats) -> Plan:
    """Put a cycle and a loop together; the steps are those of the cycle's different intervals, the weights
    (E, 3, H, m) those of what the controller has latched in its commands.
    """
    return Plan(
        cycle.what,
        cycle.place,
        *cycle.advance,
        steps1,
        steps2,
        np.ascontiguousarray(loop.sampled),
        np.ascontiguousarray(loop.force_held),
        np.ascontiguousarray(loop.force_state),
        loop.flexibility,
        cycle.past,
        weights,
    )


@inlined
def _step(matrix, y, u, fresh):  # type: ignore[no-untyped-def]
    """``y = matrix [y, u]``, column by column; `fresh` is scratch."""
    n, columns = y.shape
    for i in range(n):
        for c in range(columns):
            fresh[i, c] = 0.0
        for j in range(n):
            for c in range(columns):
                fresh[i, c] += matrix[i, j] * y[j, c]
        for j in range(u.shape[0]):
            for c in range(columns):
                fresh[i, c] += matrix[i, n + j] * u[j, c]
    for i in range(n):
        for c in range(columns):
            y[i, c] = fresh[i, c]


@inlined
def _sample(plan, columns, forcing, e):  # type: ignore[no-untyped-def]
    m = columns.u.shape[0]
    for channel in range(2):
        place = plan.place[e, channel]
        if place == NOWHERE:
            continue
        for a in range(m):
            row = channel * m + a
            for c in range(columns.p.shape[1]):
                value = forcing.sample[e, row, c] if forcing.sample.shape[0] else 0.0 * columns.p[0, c]
                for j in range(columns.p.shape[0]):
                    value += plan.sampled[row, j] * columns.p[j, c]
                columns.store[place, a, c] = value


@inlined
def _reference(plan, columns, forcing, e):  # type: ignore[no-untyped-def]
    m = columns.u.shape[0]
    to, position, velocity = plan.place[e, 0], plan.place[e, 1], plan.place[e, 2]
    for a in range(m):
        for c in range(columns.z.shape[1]):
            columns.held[a, c] = columns.store[position, a, c]
            columns.held[m + a, c] = columns.store[velocity, a, c]
    if to == NOWHERE:
        return
    for a in range(m):
        for c in range(columns.z.shape[1]):
            value = forcing.reference[e, a, c] if forcing.reference.shape[0] else 0.0 * columns.z[0, c]
            for j in range(2 * m):
                value += plan.force_held[a, j] * columns.held[j, c]
            for j in range(columns.z.shape[0]):
                value += plan.force_state[a, j] * columns.z[j, c]
            columns.store[to, a, c] = value


@inlined
def _command(plan, columns, e):  # type: ignore[no-untyped-def]
    to, position, force = plan.place[e, 0], plan.place[e, 1], plan.place[e, 2]
    if to == NOWHERE:
        return
    if plan.past.shape[2]:
        _predicted(plan, columns, e, to)
        return
    for a in range(columns.u.shape[0]):
        for c in range(columns.u.shape[1]):
            columns.store[to, a, c] = (
                columns.store[position, a, c] + plan.flexibility[a] * columns.store[force, a, c]
            )


@inlined
def _predicted(plan, columns, e, to):  # type: ignore[no-untyped-def]
    for a in range(columns.u.shape[0]):
        for c in range(columns.u.shape[1]):
            value = 0.0 * columns.u[a, c]
            for kind in range(3):
                for h in range(plan.past.shape[2]):
                    value += plan.weights[e, kind, h, a] * columns.store[plan.past[e, kind, h], a, c]
            columns.store[to, a, c] = value


@inlined
def _motor(plan, columns, e):  # type: ignore[no-untyped-def]
    for a in range(columns.u.shape[0]):
        for c in range(columns.u.shape[1]):
            columns.u[a, c] = columns.store[plan.place[e, 0], a, c]


@inlined
def _note(inputs, row):  # type: ignore[no-untyped-def]
    for a in range(inputs.shape[0]):
        for c in range(inputs.shape[1]):
            row[a, c] = inputs[a, c]


@compiled
def walk(plan: Plan, columns: Columns, forcing: Forcing) -> None:
    """Take all columns through one cycle, in place; what is remembered stays where the cycle put it."""
    fresh1, fresh2 = np.empty_like(columns.p), np.empty_like(columns.z)
    for e in range(plan.what.size + 1):
        if plan.advance1[e] >= 0:
            _step(plan.steps1[plan.advance1[e]], columns.p, columns.u, fresh1)
        if plan.advance2[e] >= 0:
            _step(plan.steps2[plan.advance2[e]], columns.z, columns.held, fresh2)
        if e == plan.what.size:
            return
        what = plan.what[e]
        if what == SAMPLE:
            _sample(plan, columns, forcing, e)
        elif what == REFERENCE:
            _reference(plan, columns, forcing, e)
            if forcing.trace.shape[0]:
                _note(columns.held, forcing.trace[e])
        elif what == COMMAND:
            _command(plan, columns, e)
        else:
            _motor(plan, columns, e)
            if forcing.trace.shape[0]:
                _note(columns.u, forcing.trace[e])
