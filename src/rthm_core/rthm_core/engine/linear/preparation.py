"""Prepare a linear loop for the kernel: matrices over every length that its program needs, and its start."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.digits import digit_lengths, work_over_digits
from rthm_core.engine.linear.kernel import Memory, Operations, Tables, vector
from rthm_core.engine.linear.ledger import COLUMNS, LinearLedger, work_tables
from rthm_core.engine.linear.loop import LinearLoop, Side
from rthm_core.engine.program import Program
from rthm_core.exponential import exponentials
from rthm_core.schedule import COMMAND, MOTOR, OUTPUT, REFERENCE, SAMPLE

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
    """A program with its matrices, and the tables of the work if it is counted."""

    operations: Operations
    tables: Tables
    work_tables: Floats | None


def _steps(side: Side, lengths_ns: Integers) -> Floats:
    """Matrices (K, n + m, n + m) of [y, s, held] over each length."""
    n, m = side.b.shape
    joint = np.zeros((n + m, n + m))
    joint[:n, :n], joint[:n, n:] = side.a, side.b
    return exponentials(joint, lengths_ns)


def _seen_through(rows: Floats, steps: Floats) -> Floats:
    """Matrices of what is seen after each step, transposed for the kernel."""
    return np.ascontiguousarray(np.swapaxes(rows @ steps, 1, 2))


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


def prepared(loop: LinearLoop, given: Numbered, ledger: LinearLedger | None) -> Prepared:
    """Matrices over the lengths of a program in which, with a ledger, both sides move jointly."""
    operations, moves, looks, ticks, rows = given
    one, two = loop.plant, loop.numerical
    n1, n2 = one.a.shape[0], two.a.shape[0]
    seen1 = _steps(one, looks)
    tables = Tables(
        _seen_through(np.eye(n1, n1 + one.b.shape[1]), _steps(one, moves)),
        _seen_through(np.eye(n2, n2 + two.b.shape[1]), _steps(two, ticks)),
        _seen_through(loop.sample, seen1),
        _seen_through(loop.rows, seen1),
        _seen_through(np.eye(two.y.size, n2 + two.b.shape[1]), _steps(two, rows)),
        np.ascontiguousarray(loop.reference.T[None]),
        loop.bias,
        loop.k_tot,
    )
    return Prepared(operations, tables, None if ledger is None else work_tables(ledger, moves, rows))


def prepared_digits(loop: LinearLoop, ledger: LinearLedger | None) -> Prepared:
    """Matrices over the lengths of every digit, for a program that is given later; what is looked at has just
    been moved.
    """
    one, two = loop.plant, loop.numerical
    n1, n2, lengths = one.a.shape[0], two.a.shape[0], digit_lengths()
    none = np.zeros(0, dtype=np.int64)
    eye1, eye2 = np.eye(n1 + one.b.shape[1])[None], np.eye(n2 + two.b.shape[1])[None]
    tables = Tables(
        _seen_through(np.eye(n1, n1 + one.b.shape[1]), _steps(one, lengths)),
        _seen_through(np.eye(n2, n2 + two.b.shape[1]), _steps(two, lengths)),
        _seen_through(loop.sample, eye1),
        _seen_through(loop.rows, eye1),
        _seen_through(np.eye(two.y.size, n2 + two.b.shape[1]), eye2),
        np.ascontiguousarray(loop.reference.T[None]),
        loop.bias,
        loop.k_tot,
    )
    nothing = Operations(none, none, none, none, none, none, 0, none)
    return Prepared(nothing, tables, None if ledger is None else work_over_digits(ledger))


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
    return one._replace(operations=one.operations._replace(plant=plant, numerical=numerical, work=work))


class Start(NamedTuple):
    """State, memory and sensors at the start of a test."""

    state: tuple[Any, ...]
    memory: Memory
    sensors: Any
    widths: tuple[Any, ...]
    work: Floats
    joint: Floats


def filled(row: Floats, needed: int) -> Floats:
    """Memory of at least so many rows, all of them what has been there before the test."""
    return np.repeat(row[None], 1 << (needed + 1).bit_length(), axis=0)


def start_of(loop: LinearLoop, samples: int, references: int) -> Start:
    """Start of a loop that looks back on so many samples and references."""
    state = [vector(v) for side in (loop.plant, loop.numerical) for v in (side.state(0.0), side.held)]
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
        np.zeros(sum(len(vector) for vector in state)),
    )


def copied(start: Start) -> Start:
    """A start that a run may change."""
    state = tuple(v if isinstance(v, tuple) else v.copy() for v in start.state)
    memory = Memory(start.memory.samples.copy(), start.memory.references.copy(), start.memory.count.copy())
    return start._replace(state=state, memory=memory, work=start.work.copy())


def widths(loop: LinearLoop) -> tuple[int, int, int]:
    """Lengths of the rows of the plant, of the numerical side and of F_d."""
    return loop.rows.shape[0], loop.numerical.y.size, loop.k_tot.size
