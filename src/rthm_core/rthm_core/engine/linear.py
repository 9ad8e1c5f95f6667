"""Simulate a linear loop: reduce it to a program and matrices once, and run the kernel."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.engine.kept import kept
from rthm_core.engine.kernel import Counting, run
from rthm_core.engine.linear_ledger import COLUMNS, LinearLedger, linear_ledger
from rthm_core.engine.linear_loop import LinearLoop, linear_loop
from rthm_core.engine.preparation import Prepared, Start, copied, prepared, start_of, widths
from rthm_core.engine.program import (
    FEW_LENGTHS,
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
    start = start_of(model.loop, int(first.sample.max()), int(first.reference.max()))
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
    _run(one, copied(start), end // one.operations.period + 1, rows)
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
    start = start_of(model.loop, reach // schedule.td1, reach // schedule.td2)
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


def kernel_call(spec: Spec, end: int, step: int) -> Callable[[], Rows] | None:
    """What `linear_rows` runs after all preparation, for measurements; None where nothing repeats."""
    model, repeating = _model(spec, False), _repeating(spec, step, False)
    if model is None or repeating is None:
        return None
    one, start = repeating
    rows = _empty_rows(model.loop, end // step + 1, energies=False)

    def call() -> Rows:
        _run(one, copied(start), end // one.operations.period + 1, rows)
        return rows

    return call
