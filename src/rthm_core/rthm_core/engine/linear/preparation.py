"""Prepare a linear loop for the kernel: matrices over every length that its program needs, and its start."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.digits import digit_lengths, work_over_digits
from rthm_core.engine.linear.kernel import Memory, Operations, Tables
from rthm_core.engine.linear.ledger import COLUMNS, LinearLedger, work_tables
from rthm_core.engine.linear.looks import only_further, periods_of
from rthm_core.engine.linear.loop import LinearLoop, Side
from rthm_core.engine.linear.periods import Periods
from rthm_core.engine.linear.totals import NOTHING, Aside
from rthm_core.engine.linear.vectors import Vector, matrices, vector
from rthm_core.engine.program import Program
from rthm_core.exponential import exponentials
from rthm_core.schedule import COMMAND, MOTOR, OUTPUT, REFERENCE, SAMPLE

LONGEST_TOGETHER = 1024
"""Longest period, in operations, whose work is counted with that of others: a longer one is seldom there
eight times, and the states of eight need memory.
"""

PLANT, NUMERICAL = (Program._fields.index(name) for name in ("plant", "numerical"))


class Numbered(NamedTuple):
    """Operations whose matrices have numbers, and the lengths (ns) of these: of steps of the plant and looks
    at it, and of both for the numerical side.
    """

    operations: Operations
    moves: Integers
    looks: Integers
    ticks: Integers
    rows: Integers


class Prepared(NamedTuple):
    """A program with its matrices, and how work is counted if it is: step by step, or of eight periods."""

    operations: Operations
    tables: Tables
    work_tables: Floats | None = None
    periods: Periods | None = None


class Model(NamedTuple):
    """A linear loop, and its ledger with what that needs beside the loop if work is counted."""

    loop: LinearLoop
    aside: Aside = NOTHING
    ledger: LinearLedger | None = None


def _steps(side: Side | Aside, lengths_ns: Integers) -> Floats:
    """Matrices (K, n + m, n + m) of [y, s, held] over each length."""
    n, m = side.b.shape
    joint = np.zeros((n + m, n + m))
    joint[:n, :n], joint[:n, n:] = side.a, side.b
    return exponentials(joint, lengths_ns)


def _seen_through(rows: Floats, steps: Floats, states: int) -> Floats:
    """Matrices of what is seen after each step of so many states, transposed for the kernel."""
    return matrices(np.swapaxes(rows @ steps, 1, 2), states)


def _lengths(first: Program, further: Program, column: int, kinds: tuple[int, ...]) -> tuple[Any, Any]:
    """Different lengths of some kinds of operation in both passes, and which one each operation takes."""
    chosen = np.logical_or.reduce([first.what == kind for kind in kinds])
    both = np.stack([first[column], further[column]])
    lengths, which = np.unique(both[:, chosen], return_inverse=True)
    numbers = np.full(both.shape, -1, dtype=np.int64)
    numbers[:, chosen] = which.reshape(2, -1)
    return lengths, numbers


def numbered(first: Program, further: Program, period: int, *, jointly: bool) -> Numbered:
    """Operations of a program whose `first` pass differs in lengths from every `further` one; `jointly`, both
    sides move at every change of an input of either.
    """
    changes = (MOTOR, COMMAND, REFERENCE)
    moves, move = _lengths(first, further, PLANT, changes if jointly else (MOTOR, COMMAND))
    looks, look = _lengths(first, further, PLANT, (SAMPLE, OUTPUT))
    ticks, tick = _lengths(first, further, NUMERICAL, changes if jointly else (REFERENCE,))
    rows, row = _lengths(first, further, NUMERICAL, (OUTPUT,))
    operations = Operations(
        first.what,
        first.time,
        np.maximum(move, look).ravel(),
        np.maximum(tick, row).ravel(),
        first.sample,
        first.reference,
        period,
        np.where(row >= 0, row + moves.size, move).ravel(),
    )
    return Numbered(operations, moves, looks, ticks, rows)


def _moves(side: Side | Aside, lengths_ns: Integers) -> Floats:
    """Matrices of the state after each step, transposed for the kernel."""
    n, m = side.b.shape
    return _seen_through(np.eye(n, n + m), _steps(side, lengths_ns), n)


def prepared(model: Model, given: Numbered) -> Prepared:
    """Matrices over the lengths of a program in which, with a ledger, both sides move jointly."""
    operations, moves, looks, ticks, rows = given
    seen1, seen2 = _steps(model.loop.plant, looks), _steps(model.loop.numerical, rows)
    tables = _tables(model, moves, ticks, seen1, seen2)
    if model.ledger is None:
        return Prepared(operations, tables)
    if operations.what.size > LONGEST_TOGETHER:
        return Prepared(operations, tables, work_tables(model.ledger, moves, rows))
    plant = model.loop.plant.a.shape[0] + model.aside.a.shape[0] + model.aside.held.size
    return Prepared(operations, tables, periods=periods_of(model.ledger, plant, operations, moves, rows))


def _tables(model: Model, moves: Integers, ticks: Integers, seen1: Floats, seen2: Floats) -> Tables:
    """Matrices over the lengths of steps of both sides, and of what is seen of them through others."""
    loop, two = model.loop, model.loop.numerical
    n1, n2 = loop.plant.a.shape[0], two.a.shape[0]
    return Tables(
        _moves(loop.plant, moves),
        _moves(two, ticks),
        _seen_through(loop.sample, seen1, n1),
        _seen_through(loop.rows, seen1, n1),
        _seen_through(np.eye(two.y.size, seen2.shape[1]), seen2, n2),
        matrices(loop.reference.T[None], n2),
        loop.bias,
        loop.k_tot,
        _moves(model.aside, moves),
        np.ascontiguousarray(model.aside.felt),
    )


def prepared_digits(model: Model) -> Prepared:
    """Matrices over the lengths of every digit, for a program that is given later; what is looked at has just
    been moved.
    """
    lengths, none = digit_lengths(), np.zeros(0, dtype=np.int64)
    eye1, eye2 = (np.eye(sum(side.b.shape))[None] for side in (model.loop.plant, model.loop.numerical))
    tables = _tables(model, lengths, lengths, eye1, eye2)
    nothing = Operations(none, none, none, none, none, none, 0, none)
    return Prepared(nothing, tables, None if model.ledger is None else work_over_digits(model.ledger))


def digit_operations(chosen: Program) -> Operations:
    """Operations of a program in digits."""
    looks = (chosen.what == SAMPLE) | (chosen.what == OUTPUT)
    step = np.where(looks, 0, chosen.plant)
    work = np.where(chosen.what == OUTPUT, digit_lengths().size, chosen.plant)
    return Operations(chosen.what, chosen.time, step, step, chosen.sample, chosen.reference, 0, work)


def without_first_pass(one: Prepared) -> Prepared:
    """The program as it goes on: every pass is a further one."""
    plant, numerical, work = (
        np.tile(both[both.size // 2 :], 2)
        for both in (one.operations.plant, one.operations.numerical, one.operations.work)
    )
    one = one._replace(operations=one.operations._replace(plant=plant, numerical=numerical, work=work))
    return one if one.periods is None else one._replace(periods=only_further(one.periods))


class Start(NamedTuple):
    """State, memory and sensors at the start of a test, and scratch."""

    state: tuple[Any, ...]
    memory: Memory
    sensors: Any
    widths: tuple[Any, ...]
    work: Floats
    joint: Floats
    scratch: Floats


def filled(row: Floats, needed: int) -> Floats:
    """Memory of at least so many rows, all of them what has been there before the test."""
    return np.repeat(row[None], 1 << (needed + 1).bit_length(), axis=0)


def start_of(model: Model, samples: int, references: int) -> Start:
    """Start of a loop that looks back on so many samples and references."""
    loop, aside = model.loop, model.aside
    state: list[Vector | None] = [
        vector(v) for side in (loop.plant, loop.numerical) for v in (side.state(0.0), side.held)
    ]
    state += [vector(v) if v.size else None for v in (aside.y, aside.held)]
    return Start(
        tuple(state),
        Memory(
            filled(loop.first_sample, samples),
            filled(loop.first_reference, references),
            np.zeros(3, dtype=np.int64),
        ),
        loop.sensors,
        tuple(vector(np.zeros(width)) for width in widths(loop)),
        np.zeros(COLUMNS),
        np.zeros(0 if model.ledger is None else model.ledger.joint.shape[0]),
        np.zeros((1, max(side.a.shape[0] for side in (loop.plant, loop.numerical, aside)))),
    )


def copied(start: Start) -> Start:
    """A start that a run may change."""
    state = tuple(v.copy() if isinstance(v, np.ndarray) else v for v in start.state)
    memory = Memory(start.memory.samples.copy(), start.memory.references.copy(), start.memory.count.copy())
    return start._replace(state=state, memory=memory, work=start.work.copy())


def widths(loop: LinearLoop) -> tuple[int, int, int]:
    """Lengths of the rows of the plant, of the numerical side and of F_d."""
    return loop.rows.shape[0], loop.numerical.y.size, loop.k_tot.size
