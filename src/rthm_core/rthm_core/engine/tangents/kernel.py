"""The compiled kernel of a loop and its tangents: what `nonlinear.kernel` runs, with derivatives beside it.

Clocks do not depend on physics, so that both follow one program. The motion is a lane of its tangents (see
`Tangents`), and is advanced with them, an arc at once where nothing switches in it; what is seen on its way
follows from its beginning. A step in which a law switches is made by itself.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import (
    Floats,
    Integers,
    called,
    compiled_in_place,
    copy_into,
    inlined,
    unrolled,
    written_out,
)
from rthm_core.engine.nonlinear.advance import Work, count_work, set_of
from rthm_core.engine.nonlinear.arc import before_arc, sticks_on
from rthm_core.engine.nonlinear.event_free import nothing_switches
from rthm_core.engine.nonlinear.kernel import Looks, add_moments, write_work, write_work_within
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.operations import Operations
from rthm_core.engine.nonlinear.steps import Steps, fill
from rthm_core.engine.tangents.advance import TangentWork, advance_tangents, begin_tangents, change_of_step
from rthm_core.engine.tangents.changes import Tangents
from rthm_core.engine.tangents.entries import Entries, Look
from rthm_core.engine.tangents.steps import look_through, of_block, put_entries
from rthm_core.lent import given, lent
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import WIDTH, element, numbers, numbers_from, put_numbers_from, will_write

ROWS_AHEAD = 8
"""How many rows ahead memory is fetched that is written: all of it does not fit into the nearest."""


class TangentSteps(NamedTuple):
    """Matrices of steps, which of them are there, what is seen after each of rows and samples, and F_d."""

    steps: Entries
    filled: Integers
    row: Look
    sample: Look
    reference: Entries


class Layout(NamedTuple):
    """What is written of each signal: its tangents and, last, itself. How many numbers these are, how many of
    them come before each group, and the lane of the motion.
    """

    columns: int
    before: tuple[int, ...]
    motion: int


@written_out
def lane_of(lanes, row, width, motion):  # type: ignore[no-untyped-def]
    """Element of the motion whose tangents these are."""
    return lanes[np.uint64(row * width + motion)]


@written_out
def move(source, begin, target, to, count):  # type: ignore[no-untyped-def]
    """Copy so many numbers, which are whole SIMD values."""
    for i in range(0, count, WIDTH):
        put_numbers_from(target, to + i, numbers_from(source, begin + i))


@called
def see_tangents(entries, slot, z, lanes, at, out, to, groups, pairs):  # type: ignore[no-untyped-def]
    """Tangents of what one of several matrices makes of z, into the flat `out` from place `to` on."""
    entries = given(entries)
    for block in range(entries.rows.shape[0]):
        sums = of_block(entries, slot, block, z, lanes, at, groups, pairs)
        for i in range(len(pairs) // len(groups)):
            begin = to + element(entries.rows, (block, i)) * (len(groups) * WIDTH)
            for group in range(len(groups)):
                put_numbers_from(out, begin + group * WIDTH, sums[i * len(groups) + group])


@written_out
def add_bias(bias, lanes, begin):  # type: ignore[no-untyped-def]
    """Add the tangents of a bias."""
    for i in range(bias.shape[0]):
        for group in range(bias.shape[1]):
            place = begin + (i * bias.shape[1] + group) * WIDTH
            put_numbers_from(lanes, place, numbers_from(lanes, place) + numbers(bias, (i, group)))


@written_out
def put_command(k_tot, change, counting, motion, own, used, asked, to, width):  # type: ignore[no-untyped-def]
    """Tangents of a command from a sample and a reference: of its two parts where work is counted."""
    m = k_tot.size
    for i in range(m):
        compliance = 1.0 / k_tot[i]
        part = lane_of(own.references, asked * m + i, width, motion) * compliance
        for lane in range(0, width, WIDTH):
            sample = numbers_from(own.samples, (used * 2 * m + i) * width + lane)
            reference = numbers_from(own.references, (asked * m + i) * width + lane)
            beside = (reference - numbers(change, (i, lane // WIDTH)) * part) * compliance
            if counting:
                put_numbers_from(own.lanes, to + i * width + lane, sample)
                put_numbers_from(own.lanes, to + (m + i) * width + lane, beside)
            else:
                put_numbers_from(own.lanes, to + i * width + lane, sample + beside)


@inlined
def _write_blocks(  # type: ignore[no-untyped-def]
    entries, slot, z, lanes, at, layout, beside, signal, groups, like
):
    """Write what all blocks of one of several matrices make of z, the first row as a `signal`. What a value
    has beyond its group is written over by what follows it.
    """
    for block in range(entries.rows.shape[0]):
        sums = of_block(entries, slot, block, z, lanes, at, groups, like)
        for i in range(len(like) // len(groups)):
            begin = (signal + element(entries.rows, (block, i))) * layout.columns
            for group in range(len(groups)):
                put_numbers_from(beside, begin + layout.before[group], sums[i * len(groups) + group])


@called
def _write_seen(  # type: ignore[no-untyped-def]
    look, slot, z, lanes, at, layout, beside, signal, groups, pairs, triples
):
    """Write what is seen through one of several matrices of a look, and its tangents."""
    _write_blocks(given(look.triples), slot, z, lanes, at, layout, beside, signal, groups, triples)
    _write_blocks(given(look.pairs), slot, z, lanes, at, layout, beside, signal, groups, pairs)


@written_out
def write(  # type: ignore[no-untyped-def]
    look, slot, z, own, at, asked, layout, m, row, beside, groups, pairs, triples
):
    """Write a row, seen through the matrix in a slot and last F_d in use, and its tangents."""
    seen, width = look.rows.shape[0], len(groups) * WIDTH
    signal, size = row * (seen + m), (seen + m) * layout.columns
    ahead = (row + ROWS_AHEAD) * size
    for place in range(ahead, ahead + size, WIDTH):
        will_write(beside, place)
    _write_seen(look, slot, z, own.lanes, at, layout, beside, signal, groups, pairs, triples)
    for i in range(m):
        begin = (signal + seen + i) * layout.columns
        for group in range(len(groups)):
            tangents = numbers_from(own.references, (asked * m + i) * width + group * WIDTH)
            put_numbers_from(beside, begin + layout.before[group], tangents)


@written_out
def _put_look(step, change, look, slot):  # type: ignore[no-untyped-def]
    """Keep what is seen after a step."""
    look_through(step, change, look)
    put_entries(look.matrix, look.change, look.triples, slot)
    put_entries(look.matrix, look.change, look.pairs, slot)


@called
def _prepare(nonlinear, steps, tangents, changes, own, number, k, slot):  # type: ignore[no-untyped-def]
    """Make a step over length `k`, and what is seen after it."""
    if not steps.filled[slot]:
        fill(nonlinear.systems[number], nonlinear.fastest, steps, slot, steps.lengths[k])
        steps.filled[slot] = 1
    change_of_step(nonlinear, steps, tangents, own, number, k)
    put_entries(steps.matrices[slot, 0], own.change, changes.steps, slot)
    _put_look(steps.matrices[slot, 0], own.change, changes.row, slot)
    _put_look(steps.matrices[slot, 0], own.change, changes.sample, slot)
    changes.filled[slot] = 1


@written_out
def _slot(nonlinear, steps, tangents, changes, own, number, k):  # type: ignore[no-untyped-def]
    """Where the matrices of a step over length `k` are."""
    slot = number * steps.lengths.size + k
    if not changes.filled[slot]:
        _prepare(nonlinear, steps, tangents, changes, own, number, k, slot)
    return slot


@written_out
def _goes_on(nonlinear, work, number, z):  # type: ignore[no-untyped-def]
    """Whether nothing switches between z and ``work.end``."""
    return nothing_switches(
        nonlinear.systems, nonlinear.holds, number, nonlinear.laws.numbers, nonlinear.n,
        nonlinear.laws.breakaway, z, work.modes, work.end,
    ) and sticks_on(nonlinear, number, work.modes, z, work.end)  # fmt: skip


@unrolled
@compiled_in_place
def run_tangents(
    nonlinear: Nonlinear,
    steps: Steps,
    work: Work,
    looks: Looks,
    operations: Operations,
    count: Integers,
    z: Floats,
    passes: int,
    rows: int,
    counted: Floats,
    tangents: Tangents,
    changes: TangentSteps,
    own: TangentWork,
    layout: Layout,
    like: Any,
    beside: Floats,
) -> None:
    """Execute a program `passes` times or until so many `rows` are written, from z on.

    The rows [x1, v1, F, x2, v2, F_d], in the order of ``changes.row``, follow each other in `beside`, which
    has room for `WIDTH` numbers more; work and energy go into `counted`. Tuples `like` are as long as there
    are groups of lanes, and these for two and for three rows.
    """
    nonlinear, steps, work = lent(nonlinear), lent(steps), lent(work)
    tangents, changes, own = lent(tangents), lent(changes), lent(own)
    groups, pairs, triples = like
    width, m, motion, d = len(groups) * WIDTH, looks.k_tot.size, layout.motion, z.size
    s_mask, r_mask = own.samples.size // (2 * m * width) - 1, own.references.size // (m * width) - 1
    s, r, row = count[0], count[1], count[2]
    size, counting, tables = nonlinear.systems.shape[1], looks.forms.shape[0] > 0, steps.work_tables
    held, inputs, as_it_is = d - nonlinear.weight.size - 2 * m, (d - size) * width, changes.filled.size
    at, to, number, arc, single = 0, d * width, -1, -1, True
    begin_tangents(nonlinear, work, tangents, z, own.halves[0])
    move(own.lanes, at + size * width, own.lanes, to + size * width, inputs)
    for p in range(passes):
        later, until = min(p, 1), -1
        for e in range(operations.what.size):
            what, k = element(operations.what, (e,)), element(operations.length, (later, e))
            span, last = element(operations.span, (later, e)), element(operations.last, (later, e))
            trying = -1
            if e > until:
                single = last < e
                trying = k if single else operations.span[later, last]
            while trying >= 0:
                number, arc = set_of(nonlinear.bits, work.modes), trying
                slot = _slot(nonlinear, steps, tangents, changes, own, number, arc)
                see_tangents(changes.steps, slot, z, own.lanes, at, own.lanes, to, groups, pairs)
                copy_into(work.end, z)
                for j in range(size):
                    work.end[j] = lane_of(own.lanes, j, width, to + motion)
                good, trying = _goes_on(nonlinear, work, number, z), -1
                if good:
                    until = e if single else last
                    before_arc(work, z, True)
                elif not single:
                    single, trying = True, k
            within = e <= until and not single and 0 <= span != arc
            if k >= 0 and e > until:
                since = (operations.time[e] + p * operations.period) * 1e-9 - steps.lengths[k]
                half = at // (d * width)
                advance_tangents(
                    nonlinear, steps, work, tangents, own, z, own.halves[half], own.halves[1 - half], k, since
                )
                add_moments(looks.forms, work.moments, work.sums)
                for j in range(d):
                    own.lanes[at + j * width + motion] = z[j]
                move(own.lanes, at + size * width, own.lanes, to + size * width, inputs)
            elif k >= 0 and not within:
                at, to = to, at
                copy_into(z, work.end)
                if counting:
                    count_work(nonlinear, tables, number, arc, work.products, work.before, work.sums)
            slot = as_it_is
            if within:
                slot = _slot(nonlinear, steps, tangents, changes, own, number, span)
            used = (s - element(operations.sample, (e,))) & s_mask
            asked = (r - element(operations.reference, (e,))) & r_mask
            if what == REFERENCE:
                begin = held * width
                move(own.samples, used * 2 * m * width, own.lanes, at + begin, 2 * m * width)
                move(own.lanes, at + begin, own.lanes, to + begin, 2 * m * width)
                for i in range(2 * m):
                    z[held + i] = lane_of(own.samples, used * 2 * m + i, width, motion)
                ring = (r & r_mask) * m * width
                see_tangents(changes.reference, 0, z, own.lanes, at, own.references, ring, groups, pairs)
                r += 1
            elif what == MOTOR:
                begin = size * width
                put_command(
                    looks.k_tot, tangents.k_tot, counting, motion, own, used, asked, at + begin, width
                )
                move(own.lanes, at + begin, own.lanes, to + begin, (held - size) * width)
                for i in range(size, held):
                    z[i] = lane_of(own.lanes, i, width, at + motion)
            elif what == SAMPLE:
                ring = (s & s_mask) * 2 * m * width
                see_tangents(changes.sample.pairs, slot, z, own.lanes, at, own.samples, ring, groups, pairs)
                add_bias(tangents.bias, own.samples, ring)
                s += 1
            elif what == OUTPUT:
                write(changes.row, slot, z, own, at, asked, layout, m, row, beside, groups, pairs, triples)
                if counting and within:
                    count_work(nonlinear, tables, number, span, work.products, work.before, work.sums)
                    write_work_within(work.sums, counted, row)
                elif counting:
                    write_work(looks.forms, work.sums, z, counted[row])
                row += 1
                if row == rows:
                    break
    if at:
        move(own.lanes, at, own.lanes, 0, d * width)
    count[0], count[1], count[2] = s, r, row
