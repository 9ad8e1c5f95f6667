"""The pass over one cycle: what becomes of any number of states of a loop at once, one in each column."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.lifted.compiled import compiled_in_place, inlined
from rthm_analysis.lifted.cycle import NOWHERE, Cycle
from rthm_analysis.lifted.matrices import LinearLoop
from rthm_core.compiled import Floats, Integers, called, plainly
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
    (places, m, L) is what is remembered; `scratch` is like `p` or `z`, whichever is larger.
    """

    p: Floats
    z: Floats
    u: Floats
    held: Floats
    store: Floats
    scratch: Floats


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


# Whatever happens is a sum of rows, so that one loop over the columns is all that is compiled for speed.


@called
def _clear(target, i):  # type: ignore[no-untyped-def]
    for c in range(target.shape[1]):
        target[i, c] = 0.0


@called
def _put(target, i, source, j):  # type: ignore[no-untyped-def]
    for c in range(target.shape[1]):
        target[i, c] = source[j, c]


@called
def _add(target, i, weight, source, j):  # type: ignore[no-untyped-def]
    for c in range(target.shape[1]):
        target[i, c] += weight * source[j, c]


@inlined
def _begin(target, i, forcing, e, row):  # type: ignore[no-untyped-def]
    if forcing.shape[0]:
        _put(target, i, forcing[e], row)
    else:
        _clear(target, i)


@inlined
def _step(matrix, y, u, fresh):  # type: ignore[no-untyped-def]
    """``y = matrix [y, u]``, column by column; `fresh` is scratch."""
    n = y.shape[0]
    for i in range(n):
        _clear(fresh, i)
        for j in range(n):
            _add(fresh, i, matrix[i, j], y, j)
        for j in range(u.shape[0]):
            _add(fresh, i, matrix[i, n + j], u, j)
    for i in range(n):
        _put(y, i, fresh, i)


@inlined
def _sample(plan, columns, forcing, e):  # type: ignore[no-untyped-def]
    m = columns.u.shape[0]
    for channel in range(2):
        place = plan.place[e, channel]
        if place == NOWHERE:
            continue
        for a in range(m):
            row = channel * m + a
            _begin(columns.store[place], a, forcing.sample, e, row)
            for j in range(columns.p.shape[0]):
                _add(columns.store[place], a, plan.sampled[row, j], columns.p, j)


@inlined
def _reference(plan, columns, forcing, e):  # type: ignore[no-untyped-def]
    m = columns.u.shape[0]
    to, position, velocity = plan.place[e, 0], plan.place[e, 1], plan.place[e, 2]
    for a in range(m):
        _put(columns.held, a, columns.store[position], a)
        _put(columns.held, m + a, columns.store[velocity], a)
    if to == NOWHERE:
        return
    for a in range(m):
        _begin(columns.store[to], a, forcing.reference, e, a)
        for j in range(2 * m):
            _add(columns.store[to], a, plan.force_held[a, j], columns.held, j)
        for j in range(columns.z.shape[0]):
            _add(columns.store[to], a, plan.force_state[a, j], columns.z, j)


@inlined
def _command(plan, columns, e):  # type: ignore[no-untyped-def]
    to, position, force = plan.place[e, 0], plan.place[e, 1], plan.place[e, 2]
    if to == NOWHERE:
        return
    if plan.past.shape[2]:
        _predicted(plan, columns, e, to)
        return
    for a in range(columns.u.shape[0]):
        _put(columns.store[to], a, columns.store[position], a)
        _add(columns.store[to], a, plan.flexibility[a], columns.store[force], a)


@inlined
def _predicted(plan, columns, e, to):  # type: ignore[no-untyped-def]
    for a in range(columns.u.shape[0]):
        _clear(columns.store[to], a)
        for kind in range(3):
            for h in range(plan.past.shape[2]):
                source = columns.store[plan.past[e, kind, h]]
                _add(columns.store[to], a, plan.weights[e, kind, h, a], source, a)


@inlined
def _copy(rows, to):  # type: ignore[no-untyped-def]
    for a in range(rows.shape[0]):
        _put(to, a, rows, a)


@plainly
@compiled_in_place
def walk(plan: Plan, columns: Columns, forcing: Forcing) -> None:
    """Take all columns through one cycle, in place; what is remembered stays where the cycle put it."""
    scratch = columns.scratch
    for e in range(plan.what.size + 1):
        if plan.advance1[e] >= 0:
            _step(plan.steps1[plan.advance1[e]], columns.p, columns.u, scratch)
        if plan.advance2[e] >= 0:
            _step(plan.steps2[plan.advance2[e]], columns.z, columns.held, scratch)
        if e == plan.what.size:
            return
        what = plan.what[e]
        if what == SAMPLE:
            _sample(plan, columns, forcing, e)
        elif what == REFERENCE:
            _reference(plan, columns, forcing, e)
            if forcing.trace.shape[0]:
                _copy(columns.held, forcing.trace[e])
        elif what == COMMAND:
            _command(plan, columns, e)
        else:
            _copy(columns.store[plan.place[e, 0]], columns.u)
            if forcing.trace.shape[0]:
                _copy(columns.u, forcing.trace[e])
