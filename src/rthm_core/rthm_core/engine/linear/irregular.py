"""Rows of a linear loop whose events do not repeat, where its clocks have few lengths."""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Integers
from rthm_core.engine.linear.arrivals import Responses, Works, rate_of, responses, works
from rthm_core.engine.linear.blocks import Rows, empty_rows
from rthm_core.engine.linear.kernel import Operations, Tables
from rthm_core.engine.linear.ledger import LinearLedger, work_tables
from rthm_core.engine.linear.loop import LinearLoop
from rthm_core.engine.linear.preparation import Model, Numbered, Start, copied, prepared, start_of
from rthm_core.engine.linear.streams import Clocks, Span, run_streams
from rthm_core.engine.program import FEW_LENGTHS, reach_ns
from rthm_core.link import NEVER
from rthm_core.schedule import Schedule


class Irregular(NamedTuple):
    """When what happens in a loop, the loop as its kernel takes it, and its start."""

    schedule: Schedule
    loop: LinearLoop
    tables: Tables
    responses: Responses
    works: Works | None
    clocks: Clocks
    start: Start


def clocks_of(schedule: Schedule, step: int) -> Clocks:
    """Clocks of a loop with a row every `step` ns."""
    periods = np.array([schedule.td1, schedule.td2, step])
    unit = int(np.gcd.reduce(periods))
    return Clocks(unit, *(periods // unit).tolist())


def irregular(
    schedule: Schedule, loop: LinearLoop, ledger: LinearLedger | None, step: int
) -> Irregular | None:
    """A loop with a row every `step` ns; None where its clocks have many lengths, or they are long."""
    clocks = clocks_of(schedule, step)
    most = min(clocks.row, clocks.td2)
    if most > FEW_LENGTHS:
        return None
    longest, rate = most * clocks.unit, rate_of(loop, ledger)
    found = responses(loop, longest, rate)
    if found is None:
        return None
    reach = reach_ns(schedule)
    lengths = _lengths(np.arange(most + 1) * clocks.unit)
    counting = None
    if ledger is not None:
        counting = works(ledger, work_tables(ledger, lengths.moves, lengths.rows), longest, rate)
    start = start_of(Model(loop), reach // schedule.td1, reach // schedule.td2)
    tables = prepared(Model(loop), lengths).tables
    return Irregular(schedule, loop, tables, found, counting, clocks, start)


def _lengths(lengths: Integers) -> Numbered:
    """Operations of no program, over every one of these lengths; nothing is looked at but the present."""
    none, now = np.zeros(0, dtype=np.int64), np.zeros(1, dtype=np.int64)
    nothing = Operations(none, none, none, none, none, none, 0, none)
    return Numbered(nothing, lengths, now, lengths, now)


def irregular_blocks(one: Irregular, end: int, span: int) -> Iterator[Rows]:
    """Rows up to `end` ns, in blocks of about `span` ns."""
    schedule = copy(one.schedule)  # which will hold the commands of a span
    step, start = one.clocks.row * one.clocks.unit, copied(one.start)
    counting = None if one.works is None else one.works._replace(sums=np.zeros_like(one.works.sums))
    state, last = start.state[:4], end // step + 1
    each = -(-span // step)
    for first in range(0, last, each):
        rows = empty_rows(one.loop, min(each, last - first), energies=counting is not None)
        state = run_streams(
            one.tables,
            one.responses,
            counting,
            _span(one.clocks, schedule, first, rows.plant.shape[0]),
            start.memory,
            start.sensors,
            state,
            (tuple(rows), start.widths),
        )
        yield rows


def _span(clocks: Clocks, schedule: Schedule, first: int, count: int) -> Span:
    """What happens up to a row, from the row before a `first` on."""
    step = clocks.row * clocks.unit
    begin, end = (first - 1) * step + 1 if first else 0, (first + count - 1) * step
    found, later = schedule.streams(begin, end + 1), end // schedule.td1 + 1
    return Span(
        clocks,
        max(first - 1, 0) * clocks.row,
        first,
        -(-begin // schedule.td2),
        found.commands.time,
        _ended(found.commands.state, later),
        found.commands.reference,
        _ended(found.ticks, later),
        _ended(2 * found.due + found.late, NEVER),
        found.which,
    )


def _ended(numbers: Integers, last: int) -> Integers:
    """Numbers with one more at their end."""
    ended = np.empty(numbers.size + 1, dtype=np.int64)
    ended[:-1], ended[-1] = numbers, last
    return ended
