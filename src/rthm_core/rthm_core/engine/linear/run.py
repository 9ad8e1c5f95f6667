"""Simulate a linear loop: reduce it to a program and matrices once, and run the kernel."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.engine.digits import LONGEST_LENGTH, in_digits
from rthm_core.engine.linear.blocks import CHUNK_NS, Rows, empty_rows, rows_within, run_block, run_program
from rthm_core.engine.linear.irregular import Irregular, irregular, irregular_blocks
from rthm_core.engine.linear.ledger import linear_ledger
from rthm_core.engine.linear.loop import linear_loop
from rthm_core.engine.linear.preparation import (
    Model,
    Numbered,
    Prepared,
    Start,
    copied,
    digit_operations,
    numbered,
    prepared,
    prepared_digits,
    start_of,
    without_first_pass,
)
from rthm_core.engine.linear.totals import beside
from rthm_core.engine.program import (
    FEW_LENGTHS,
    Program,
    last_changes,
    period_ns,
    program,
    reach_ns,
    with_lengths,
)
from rthm_core.kept import kept, kept_by_clocks, kept_without_timing
from rthm_core.schedule import Schedule

if TYPE_CHECKING:
    from rthm_core.spec import Spec


@kept_without_timing
def _model(spec: Spec, energies: bool) -> Model | None:
    """Matrices of a spec; None where it is not linear."""
    loop = linear_loop(spec)
    if loop is None or not energies:
        return None if loop is None else Model(loop)
    return Model(loop, *beside(linear_ledger(spec, loop), loop))


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
    model, found = _model(spec, energies), _numbered(spec, step, energies)
    if model is None or found is None:
        return None
    back = found.operations
    start = start_of(model, int(back.sample.max()), int(back.reference.max()))
    return prepared(model, found), start


@kept_by_clocks
def _numbered(spec: Spec, step: int, energies: bool) -> Numbered | None:
    """Operations of one hyperperiod; None where nothing repeats."""
    found = repeating_program(spec, step, jointly=energies)
    return None if found is None else numbered(*found, jointly=energies)


LARGEST_JOINT = 16
"""Largest joint state of which work over many different lengths is tabulated."""


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
    large = model.ledger is not None and model.ledger.joint.shape[0] > LARGEST_JOINT
    if large or step >= LONGEST_LENGTH:
        return None
    one = _clocked(spec, step, energies)
    if one is None:
        return _irregular(spec, model, end, step)
    return irregular_blocks(one, end, span)


@kept
def _clocked(spec: Spec, step: int, energies: bool) -> Irregular | None:
    """What the kernel of irregular events needs; None where clocks have many lengths."""
    loop = linear_loop(spec)
    assert loop is not None
    ledger = linear_ledger(spec, loop) if energies else None
    loop = loop if ledger is None else ledger.loop
    return irregular(Schedule(spec), loop, ledger, step)


def _repeated(model: Model, one: Prepared, start: Start, end: int, step: int, span: int) -> Iterator[Rows]:
    """Blocks of a loop whose events repeat."""
    period, times = one.operations.period, one.operations.time
    passes = max(1, -(-span // period))
    start = copied(start)
    for begin in range(0, end + 1, passes * period):
        count = rows_within(begin, min(begin + passes * period, end + 1), step)
        rows = empty_rows(model.loop, count + 1, energies=model.ledger is not None)
        left = min(passes, (end - begin) // period + 1)
        if begin:
            one = without_first_pass(one)
        operations = one.operations._replace(time=times + begin)
        block, start = run_block(one._replace(operations=operations), start, left, rows)
        yield block


@kept_without_timing
def _digits(spec: Spec, energies: bool) -> Prepared:
    """Matrices over the lengths of every digit, without a program."""
    model = _model(spec, energies)
    assert model is not None
    return prepared_digits(model)


def _irregular(spec: Spec, model: Model, end: int, step: int) -> Iterator[Rows]:
    """Blocks of a loop whose events do not repeat."""
    schedule, since, one = Schedule(spec), 0, _digits(spec, model.ledger is not None)
    reach = reach_ns(schedule)
    start = start_of(model, reach // schedule.td1, reach // schedule.td2)
    for begin in range(0, end + 1, CHUNK_NS):
        stop = min(begin + CHUNK_NS, end + 1)
        operations = program(schedule, begin, stop, step)
        chosen = one._replace(operations=digit_operations(in_digits(operations, since)))
        rows = empty_rows(model.loop, rows_within(begin, stop, step) + 1, energies=model.ledger is not None)
        block, start = run_block(chosen, start, 1, rows)
        yield block
        since = int(operations.time.max(initial=since))


def prepared_loop(spec: Spec, step: int) -> tuple[Prepared, Start] | None:
    """What the kernel executes without work, and its start, for measurements; None where nothing repeats."""
    return _repeating(spec, step, False)


def kernel_call(spec: Spec, end: int, step: int) -> Callable[[], Rows] | None:
    """What `linear_blocks` runs after all preparation, for measurements; None where nothing repeats."""
    model, repeating = _model(spec, False), _repeating(spec, step, False)
    if model is None or repeating is None:
        return None
    one, start = repeating
    rows = empty_rows(model.loop, end // step + 1, energies=False)

    def call() -> Rows:
        run_program(one, copied(start), end // one.operations.period + 1, rows)
        return rows

    return call
