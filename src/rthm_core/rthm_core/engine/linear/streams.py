"""The compiled kernel of linear loops whose events do not repeat: from instant to instant of the clocks, with
what commands add that arrive in between.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Integers, fused, written_out
from rthm_core.engine.linear.arrivals import Responses, Works
from rthm_core.engine.linear.arriving import (
    added_work,
    changed,
    inlined_state,
    joint,
    passed,
    piece,
    responded,
)
from rthm_core.engine.linear.kernel import Memory, Tables
from rthm_core.engine.linear.vectors import moved, put, seen
from rthm_core.engine.worked import energy, worked
from rthm_core.physical.sensors import Sensors, measured
from rthm_core.simd import numbers, put_numbers


class Clocks(NamedTuple):
    """Greatest length in ns of which all periods are multiples, and these multiples."""

    unit: int
    td1: int
    td2: int
    row: int


class Span(NamedTuple):
    """What happens in a span of time, as `schedule.Streams` has it; each of `sent_sample`, `tick_sample` and
    `due` has one more at its end, which is beyond the span.

    Attributes
    ----------
    clocks : Clocks
    begin : int
        Instant of the clocks, in their unit, at which the span before ended.
    row, tick : int
        Numbers of the first row and the first tick of the numerical side.
    sent, sent_sample, sent_reference : arrays
        When commands were sent, in ns, and the numbers of what they use.
    tick_sample : array
        Numbers of the samples that ticks use.
    due, which : arrays
        Twice the instant in ns at which a command arrives, and one more if all else that happens then comes
        before; which command it is.
    """

    clocks: Clocks
    begin: int
    row: int
    tick: int
    sent: Integers
    sent_sample: Integers
    sent_reference: Integers
    tick_sample: Integers
    due: Integers
    which: Integers


@written_out
def _place(number):  # type: ignore[no-untyped-def]
    """A number that is not negative as an index: the compiler then leaves out counting from the end."""
    return np.uint64(number)


@written_out
def _within(number, ring):  # type: ignore[no-untyped-def]
    """Where a memory has what has this number."""
    return np.uint64(number & (ring.shape[0] - 1))


@written_out
def _beyond(numbers_used, at, last):  # type: ignore[no-untyped-def]
    """First place from `at` on that uses what is newer than `last`."""
    while numbers_used[_place(at)] <= last:
        at += 1
    return at


@written_out
def _input(tables, memory, sample, reference, parts, j):  # type: ignore[no-untyped-def]
    """Input `j` of the plant by a command, whose parts are one input or two."""
    m, value = tables.k_tot.size, 0.0
    if j < m:
        value = memory.samples[sample, j]
    if j >= m or parts == m:
        i = j if j < m else j - m
        value += memory.references[reference, i] / tables.k_tot[i]
    return value


@inlined_state
def _arrive(tables, memory, span, arriving, command, change):  # type: ignore[no-untyped-def]
    """The command that arrives next as the inputs of the plant, and their change."""
    which = _place(span.which[_place(arriving)])
    sample = _within(span.sent_sample[which], memory.samples)
    reference = _within(span.sent_reference[which], memory.references)
    for j in range(len(command)):
        value = _input(tables, memory, sample, reference, len(command), j)
        change = put(change, j, value - command[j])
        command = put(command, j, value)
    return command, change


@written_out
def _sample(tables, memory, sensors, number, stamp, plant, command, held):  # type: ignore[no-untyped-def]
    """Keep a sample of the plant."""
    samples, bias = memory.samples, tables.bias
    new = _within(number, samples)
    seen(tables.sample, 0, plant, command, samples, new, held)
    for i in range(len(held)):
        samples[new, i] += bias[i]
        if sensors is not None:
            samples[new, i] = measured(sensors, i, samples[new, i], bias, stamp)


@inlined_state
def _tick(tables, memory, span, number, numerical, held, like):  # type: ignore[no-untyped-def]
    """Latch a sample and keep a reference; the held motion."""
    used = _within(span.tick_sample[_place(number - span.tick)], memory.samples)
    for i in range(len(held)):
        held = put(held, i, memory.samples[used, i])
    new = _within(number, memory.references)
    seen(tables.reference, 0, numerical, held, memory.references, new, like)
    return held


@written_out
def _row(tables, memory, span, giver, row, plant, command, numerical, held, rows):  # type: ignore[no-untyped-def]
    """Write a row, in which the controller uses the reference of the command before `giver`."""
    (plant_out, numerical_out, reference_out, _), like = rows
    seen(tables.plant_row, 0, plant, command, plant_out, row, like[0])
    seen(tables.numerical_row, 0, numerical, held, numerical_out, row, like[1])
    number = span.sent_reference[_place(giver - 1)] if giver > 0 else -1
    reference = _within(number, memory.references)
    for i in range(len(like[2])):
        reference_out[row, i] = memory.references[reference, i]


@fused
def run_streams(
    tables: Tables,
    responses: Responses,
    works: Works | None,
    span: Span,
    memory: Memory,
    sensors: Sensors | None,
    state: Any,
    rows: Any,
) -> Any:
    """Execute a span of time and fill its rows; the states and held inputs at the last of them.

    The memory has every sample and reference at its number, and counts those that are there.
    """
    plant, command, numerical, held = state
    clocks, count, work_out, like = span.clocks, memory.count, rows[0][3], rows[1]
    unit, now, row, taken, tick = clocks.unit, span.begin, 0, count[0] - 1, count[1]
    scratch1, scratch2 = np.empty((1, len(plant))), np.empty((1, len(numerical)))
    sender, user = _beyond(span.sent_sample, 0, taken), _beyond(span.tick_sample, 0, taken)
    giver, arriving, change = 0, 0, responses.change
    if works is not None:
        sums = numbers(works.sums, (0,))
    while row < rows[0][0].shape[0]:
        sampled = min(span.sent_sample[_place(sender)], span.tick_sample[_place(user)])
        at_row, begin = (span.row + row) * clocks.row, now
        now = min(at_row, min(sampled * clocks.td1, tick * clocks.td2))
        step = _place(now - begin)
        if works is not None:
            z, last = joint(works.z, plant, command, numerical, held), begin * unit
            sums += worked(works.tables, step, z)
        plant = moved(tables.plant, step, plant, command, scratch1)
        numerical = moved(tables.numerical, step, numerical, held, scratch2)
        while span.due[_place(arriving)] <= 2 * now * unit:
            due = span.due[_place(arriving)] >> 1
            command, change = _arrive(tables, memory, span, arriving, command, change)
            k, x = piece(responses, now * unit - due)
            plant = responded(responses.terms, k, x, change, plant)
            if works is not None:
                z, last = changed(passed(works, responses, due - last, z), len(plant), 0.5, change), due
                sums += added_work(works, k, x, change, z)
                z = changed(z, len(plant), 0.5, change)
            arriving += 1
        if now == sampled * clocks.td1:
            _sample(tables, memory, sensors, sampled, now * unit, plant, command, held)
            taken = sampled
            sender, user = _beyond(span.sent_sample, sender, taken), _beyond(span.tick_sample, user, taken)
        if now == tick * clocks.td2:
            held = _tick(tables, memory, span, tick, numerical, held, like[2])
            tick += 1
        while span.due[_place(arriving)] <= 2 * now * unit + 1:
            command, change = _arrive(tables, memory, span, arriving, command, change)
            arriving += 1
        if now == at_row:
            while giver < span.sent.size and span.sent[_place(giver)] <= now * unit:
                giver += 1
            _row(tables, memory, span, giver, _place(row), plant, command, numerical, held, rows)
            if works is not None:
                z = joint(works.z, plant, command, numerical, held)
                put_numbers(work_out, (row,), sums)
                work_out[row, 6] = energy(works.energy, z)
            row += 1
    if works is not None:
        put_numbers(works.sums, (0,), sums)
    count[0], count[1] = taken + 1, tick
    return plant, command, numerical, held
