"""Simulate a linear loop: reduce it to a program and matrices once, and run the kernel."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.engine.kept import kept
from rthm_core.engine.kernel import ROWS, Counting, run
from rthm_core.engine.linear_ledger import COLUMNS, LinearLedger, linear_ledger
from rthm_core.engine.linear_loop import LinearLoop, linear_loop
from rthm_core.engine.preparation import (
    Prepared,
    Start,
    copied,
    prepared,
    start_of,
    widths,
    without_first_pass,
)
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
from rthm_core.schedule import REFERENCE, Schedule

if TYPE_CHECKING:
    from rthm_core.spec import Spec


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
    plant, numerical, reference = (np.empty((count, width)) for width in widths(loop))
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


def repeating_program(spec: Spec, step: int, *, jointly: bool = False) -> tuple[Program, Program, int] | None:
    """Program of one hyperperiod with a row every `step` ns: first pass, every further one, its length in ns.

    None where nothing repeats or the lengths are too many.
    """
    schedule = Schedule(spec)
    period = period_ns(spec, schedule, step)
    if period is None:
        return None
    begin = -(-reach_ns(schedule) // period) * period
    operations = program(schedule, begin, begin + period, step)
    operations = operations._replace(time=operations.time - begin)
    first = with_lengths(operations, (0, 0), jointly=jointly)
    end = last_changes(operations, (0, 0), jointly=jointly)
    further = with_lengths(operations, (end[0] - period, end[1] - period), jointly=jointly)
    few = np.unique([first.plant, further.plant]).size <= FEW_LENGTHS
    return (first, further, period) if few else None


@kept
def _repeating(spec: Spec, step: int, energies: bool) -> tuple[Prepared, Start] | None:
    """What the kernel needs for one hyperperiod; None where nothing repeats."""
    model, found = _model(spec, energies), repeating_program(spec, step, jointly=energies)
    if model is None or found is None:
        return None
    first, further, period = found
    start = start_of(model.loop, int(first.sample.max()), int(first.reference.max()))
    return prepared(model.loop, first, further, period, model.ledger), start


CHUNK_NS = 10_000_000_000
"""Span of time that is held at once where a run is given in blocks, or where nothing repeats."""

LARGEST_JOINT = 16
"""Largest joint state of which works over many different lengths are tabulated."""


def linear_blocks(
    spec: Spec, end: int, step: int, *, energies: bool, span: int = CHUNK_NS
) -> Iterator[Rows] | None:
    """Rows of a linear loop every `step` ns up to `end` ns, in blocks of about `span` ns; None where there is
    no fast way for it.
    """
    model = _model(spec, energies)
    if model is None:
        return None
    repeating = _repeating(spec, step, energies)
    if repeating is not None:
        return _repeated(model, *repeating, end, step, span)
    if model.ledger is not None and model.ledger.joint.shape[0] > LARGEST_JOINT:
        return None
    return _irregular(spec, model, end, step)


def _block(one: Prepared, start: Start, passes: int, rows: Rows) -> tuple[Rows, Start]:
    """Run a program and leave its last row, which is beyond the block: a full block would end the run."""
    start.memory.count[ROWS] = 0
    state = _run(one, start, passes, rows)
    return Rows(*(array[:-1] for array in rows)), start._replace(state=state)


def rows_within(begin: int, stop: int, step: int) -> int:
    """Number of rows in [begin, stop)."""
    return -(-stop // step) - -(-begin // step)


def _repeated(model: _Model, one: Prepared, start: Start, end: int, step: int, span: int) -> Iterator[Rows]:
    """Blocks of a loop whose events repeat."""
    period, times = one.operations.period, one.operations.time
    passes = max(1, -(-span // period))
    start, further = copied(start), without_first_pass(one)
    for begin in range(0, end + 1, passes * period):
        count = rows_within(begin, min(begin + passes * period, end + 1), step)
        rows = _empty_rows(model.loop, count + 1, energies=one.works is not None)
        left = min(passes, (end - begin) // period + 1)
        operations = one.operations._replace(time=times + begin) if begin else one.operations
        block, start = _block(one._replace(operations=operations), start, left, rows)
        yield block
        one = further


def _irregular(spec: Spec, model: _Model, end: int, step: int) -> Iterator[Rows]:
    """Blocks of a loop whose events do not repeat."""
    counting, schedule, since = model.ledger is not None, Schedule(spec), (0, 0)
    reach = reach_ns(schedule)
    start = start_of(model.loop, reach // schedule.td1, reach // schedule.td2)
    for begin in range(0, end + 1, CHUNK_NS):
        stop = min(begin + CHUNK_NS, end + 1)
        operations = program(schedule, begin, stop, step)
        chosen = with_lengths(operations, since, jointly=counting)
        since_then = last_changes(operations, since, jointly=counting)
        if np.unique(chosen.plant).size > FEW_LENGTHS:
            chosen = in_digits(chosen, since[0], jointly=counting)
            moved = operations.time[(operations.what != REFERENCE) | counting]
            since_then = (int(moved.max(initial=since[0])), since_then[1])
        one = prepared(model.loop, chosen, chosen, 0, model.ledger)
        rows = _empty_rows(model.loop, rows_within(begin, stop, step) + 1, energies=counting)
        block, start = _block(one, start, 1, rows)
        yield block
        since = since_then


def kernel_call(spec: Spec, end: int, step: int) -> Callable[[], Rows] | None:
    """What `linear_blocks` runs after all preparation, for measurements; None where nothing repeats."""
    model, repeating = _model(spec, False), _repeating(spec, step, False)
    if model is None or repeating is None:
        return None
    one, start = repeating
    rows = _empty_rows(model.loop, end // step + 1, energies=False)

    def call() -> Rows:
        _run(one, copied(start), end // one.operations.period + 1, rows)
        return rows

    return call
