"""Simulate a linear loop: build its program and its matrices once, and run the kernel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.exponential import exponentials
from rthm_core.engine.kept import kept
from rthm_core.engine.kernel import Counting, Memory, Operations, Tables, run, vector
from rthm_core.engine.linear_ledger import COLUMNS, LinearLedger, linear_ledger, work_tables
from rthm_core.engine.linear_loop import LinearLoop, Side, linear_loop
from rthm_core.engine.program import (
    FEW_LENGTHS,
    Program,
    in_digits,
    last_changes,
    period_ns,
    program,
    reach_ns,
    with_lengths,
)
from rthm_core.schedule import COMMAND, MOTOR, OUTPUT, REFERENCE, SAMPLE, Schedule

if TYPE_CHECKING:
    from rthm_core.spec import Spec


PLANT, NUMERICAL = (Program._fields.index(name) for name in ("plant", "numerical"))


class Prepared(NamedTuple):
    """A program with its matrices, and the tables of the works if they are counted."""

    operations: Operations
    tables: Tables
    works: Floats | None


def _steps(side: Side, lengths_ns: Integers) -> Floats:
    """Matrices (K, n + m, n + m) of [y, s, held] over each length."""
    n, m = side.b.shape
    joint = np.zeros((n + m, n + m))
    joint[:n, :n], joint[:n, n:] = side.a, side.b
    return exponentials(joint, lengths_ns)


def _seen_through(rows: Floats, steps: Floats) -> Floats:
    """Matrices of what is seen after each step, transposed for the kernel."""
    return np.ascontiguousarray(np.swapaxes(rows @ steps, 1, 2))


def _numbered(first: Program, further: Program, column: int, kinds: tuple[int, ...]) -> tuple[Any, Any]:
    """Different lengths of some kinds of operation in both passes, and which one each operation takes."""
    chosen = np.isin(first.what, kinds)
    both = np.stack([first[column], further[column]])
    lengths, which = np.unique(both[:, chosen], return_inverse=True)
    numbers = np.full(both.shape, -1, dtype=np.int64)
    numbers[:, chosen] = which.reshape(2, -1)
    return lengths, numbers


def prepared(
    loop: LinearLoop, first: Program, further: Program, period: int, ledger: LinearLedger | None
) -> Prepared:
    """Matrices and operations of a program whose `first` pass differs in lengths from every `further` one."""
    one, two = loop.plant, loop.numerical
    n1, n2 = one.a.shape[0], two.a.shape[0]
    changes = (MOTOR, COMMAND, REFERENCE)
    moves, move = _numbered(first, further, PLANT, changes if ledger else (MOTOR, COMMAND))
    looks, look = _numbered(first, further, PLANT, (SAMPLE, OUTPUT))
    ticks, tick = _numbered(first, further, NUMERICAL, changes if ledger else (REFERENCE,))
    rows, row = _numbered(first, further, NUMERICAL, (OUTPUT,))
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
    if ledger is None:
        return Prepared(operations, tables, None)
    works = [
        work_tables(ledger, moves, with_energy=False),
        work_tables(ledger, rows, with_energy=True),
    ]
    return Prepared(operations, tables, np.concatenate(works))


class Start(NamedTuple):
    """State, memory and sensors at the start of a test."""

    state: tuple[Any, ...]
    memory: Memory
    sensors: Any
    widths: tuple[Any, ...]
    works: Floats
    joint: Floats


def _start(loop: LinearLoop, samples: int, references: int) -> Start:
    """Start of a loop that looks back on so many samples and references."""

    def filled(row: Floats, needed: int) -> Floats:
        return np.tile(row, (1 << (needed + 1).bit_length(), 1))

    state = [vector(v) for side in (loop.plant, loop.numerical) for v in (side.state(0.0), side.held)]
    return Start(
        tuple(state),
        Memory(
            filled(loop.first_sample, samples),
            filled(loop.first_reference, references),
            np.zeros(3, dtype=np.int64),
        ),
        loop.sensors,
        tuple(vector(np.zeros(width)) for width in _widths(loop)),
        np.zeros(COLUMNS),
        np.zeros(sum(len(vector) for vector in state)),
    )


def _copied(start: Start) -> Start:
    """A start that a run may change."""
    state = tuple(v if isinstance(v, tuple) else v.copy() for v in start.state)
    memory = Memory(start.memory.samples.copy(), start.memory.references.copy(), start.memory.count.copy())
    return start._replace(state=state, memory=memory, works=start.works.copy())


def _widths(loop: LinearLoop) -> tuple[int, int, int]:
    return loop.rows.shape[0], loop.numerical.y.size, loop.k_tot.size


class Rows(NamedTuple):
    """What the kernel writes, N rows each.

    Plant (N, 2 n1 + m), numerical side (N, 2 n2), F_d in use (N, m), works and energy (N, 8), which has no
    rows when they are not counted.
    """

    plant: Floats
    numerical: Floats
    reference: Floats
    works: Floats


def _empty_rows(loop: LinearLoop, count: int, *, energies: bool) -> Rows:
    plant, numerical, reference = (np.empty((count, width)) for width in _widths(loop))
    return Rows(plant, numerical, reference, np.empty((count if energies else 0, COLUMNS)))


def _run(one: Prepared, start: Start, passes: int, rows: Rows) -> tuple[Any, ...]:
    """Run a program from a start, whose memory it changes; the state at its end."""
    counting = None if one.works is None else Counting(one.works, start.works, start.joint)
    plant, commands, numerical, held = start.state
    return run(
        one.tables,
        one.operations,
        start.memory,
        start.sensors,
        counting,
        plant,
        commands,
        numerical,
        held,
        passes,
        tuple(rows),
        start.widths,
    )


class _Model(NamedTuple):
    """A linear loop, and its ledger if works are counted."""

    loop: LinearLoop
    ledger: LinearLedger | None


@kept
def _model(spec: Spec, energies: bool) -> _Model | None:
    """Matrices of a spec; None where it is not linear."""
    loop = linear_loop(spec)
    if loop is None or not energies:
        return None if loop is None else _Model(loop, None)
    ledger = linear_ledger(spec, loop)
    return _Model(ledger.loop, ledger)


@kept
def _repeating(spec: Spec, step: int, energies: bool) -> tuple[Prepared, Start] | None:
    """Program of one hyperperiod; None where there is none or it has too many different lengths."""
    model, schedule = _model(spec, energies), Schedule(spec)
    period = period_ns(spec, schedule, step)
    if model is None or period is None:
        return None
    begin = -(-reach_ns(schedule) // period) * period
    operations = program(schedule, begin, begin + period, step)
    operations = operations._replace(time=operations.time - begin)
    first = with_lengths(operations, (0, 0), jointly=energies)
    end = last_changes(operations, (0, 0), jointly=energies)
    further = with_lengths(operations, (end[0] - period, end[1] - period), jointly=energies)
    if np.unique([first.plant, further.plant]).size > FEW_LENGTHS:
        return None
    start = _start(model.loop, int(first.sample.max()), int(first.reference.max()))
    return prepared(model.loop, first, further, period, model.ledger), start


def linear_rows(spec: Spec, end: int, step: int, *, energies: bool = False) -> Rows | None:
    """Rows of a linear loop every `step` ns up to `end` ns; None where there is no fast way for it."""
    model = _model(spec, energies)
    if model is None:
        return None
    repeating = _repeating(spec, step, energies)
    if repeating is None:
        return _irregular(spec, model, end, step)
    one, start = repeating
    rows = _empty_rows(model.loop, end // step + 1, energies=energies)
    _run(one, _copied(start), end // one.operations.period + 1, rows)
    return rows


CHUNK_NS = 10_000_000_000
"""Span of time whose operations are held at once where nothing repeats."""

LARGEST_JOINT = 16
"""Largest joint state of which works over many different lengths are tabulated."""


def _irregular(spec: Spec, model: _Model, end: int, step: int) -> Rows | None:
    """Rows of a loop whose events do not repeat, a span of time at once."""
    counting = model.ledger is not None
    if model.ledger is not None and model.ledger.joint.shape[0] > LARGEST_JOINT:
        return None
    schedule = Schedule(spec)
    reach = reach_ns(schedule)
    start = _start(model.loop, reach // schedule.td1, reach // schedule.td2)
    rows = _empty_rows(model.loop, end // step + 1, energies=counting)
    since = (0, 0)
    for begin in range(0, end + 1, CHUNK_NS):
        operations = program(schedule, begin, min(begin + CHUNK_NS, end + 1), step)
        chosen = with_lengths(operations, since, jointly=counting)
        after = last_changes(operations, since, jointly=counting)
        if np.unique(chosen.plant).size > FEW_LENGTHS:
            chosen = in_digits(chosen, since[0], jointly=counting)
            moved = operations.time[(operations.what != REFERENCE) | counting]
            after = (int(moved.max(initial=since[0])), after[1])
        one = prepared(model.loop, chosen, chosen, 0, model.ledger)
        start = start._replace(state=_run(one, start, 1, rows))
        since = after
    return rows
