"""The compiled kernel of a loop and its tangents: what `nonlinear.kernel` runs, with derivatives beside it.

Clocks do not depend on physics, so that both follow one program. The motion is a lane of its tangents (see
`Tangents`), and is advanced with them, an arc at once where nothing switches in it; what is seen on its way
follows from its beginning. A step in which a law switches is made by itself.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, copy_into, written_out
from rthm_core.engine.nonlinear.advance import Work, count_work, set_of
from rthm_core.engine.nonlinear.arc import before_arc, sticks_on
from rthm_core.engine.nonlinear.event_free import nothing_switches
from rthm_core.engine.nonlinear.kernel import Looks, Outputs, add_moments, write_work, write_work_within
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.operations import Operations
from rthm_core.engine.nonlinear.steps import Steps, fill
from rthm_core.engine.tangents.advance import TangentWork, advance_tangents, begin_tangents, change_of_step
from rthm_core.engine.tangents.changes import Tangents
from rthm_core.engine.tangents.entries import Entries, Look
from rthm_core.engine.tangents.steps import look_through, of_block, put_entries
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import WIDTH, element, numbers, numbers_from, put_first, put_numbers_from


class TangentSteps(NamedTuple):
    """Matrices of steps, which of them are there, what is seen after each of rows and samples, and F_d."""

    steps: Entries
    filled: Integers
    row: Look
    sample: Look
    reference: Entries


class Layout(NamedTuple):
    """Number of parameters, those before and in each group, and the lane of the motion."""

    parameters: int
    before: tuple[int, ...]
    counts: tuple[int, ...]
    motion: int


@written_out
def _lane(lanes, row, width, motion):  # type: ignore[no-untyped-def]
    """Element of the motion whose tangents these are."""
    return lanes[np.uint64(row * width + motion)]


@written_out
def _move(source, begin, target, to, count):  # type: ignore[no-untyped-def]
    """Copy so many numbers, which are whole SIMD values."""
    for i in range(0, count, WIDTH):
        put_numbers_from(target, to + i, numbers_from(source, begin + i))


@called
def _seen(entries, slot, z, lanes, at, out, to, groups, pairs):  # type: ignore[no-untyped-def]
    """Tangents of what one of several matrices makes of z, into the flat `out` from place `to` on."""
    for block in range(entries.rows.shape[0]):
        sums = of_block(entries, slot, block, z, lanes, at, groups, pairs)
        for i in range(len(pairs) // len(groups)):
            begin = to + element(entries.rows, (block, i)) * (len(groups) * WIDTH)
            for group in range(len(groups)):
                put_numbers_from(out, begin + group * WIDTH, sums[i * len(groups) + group])


@written_out
def _add(bias, lanes, begin):  # type: ignore[no-untyped-def]
    """Add the tangents of a bias."""
    for i in range(bias.shape[0]):
        for group in range(bias.shape[1]):
            place = begin + (i * bias.shape[1] + group) * WIDTH
            put_numbers_from(lanes, place, numbers_from(lanes, place) + numbers(bias, (i, group)))


@written_out
def _command(k_tot, change, counting, motion, own, used, asked, to, width):  # type: ignore[no-untyped-def]
    """Tangents of a command from a sample and a reference: of its two parts where work is counted."""
    m = k_tot.size
    for i in range(m):
        compliance = 1.0 / k_tot[i]
        part = _lane(own.references, asked * m + i, width, motion) * compliance
        for lane in range(0, width, WIDTH):
            sample = numbers_from(own.samples, (used * 2 * m + i) * width + lane)
            reference = numbers_from(own.references, (asked * m + i) * width + lane)
            beside = (reference - numbers(change, (i, lane // WIDTH)) * part) * compliance
            if counting:
                put_numbers_from(own.lanes, to + i * width + lane, sample)
                put_numbers_from(own.lanes, to + (m + i) * width + lane, beside)
            else:
                put_numbers_from(own.lanes, to + i * width + lane, sample + beside)


@written_out
def _put(layout, beside, signal, group, tangents):  # type: ignore[no-untyped-def]
    """Write the tangents of a signal with respect to the parameters of a group."""
    begin = signal * layout.parameters + layout.before[group]
    put_first(beside, (begin,), tangents, layout.counts[group])


@written_out
def _write_seen(entries, slot, z, own, at, layout, beside, signal, groups, triples):  # type: ignore[no-untyped-def]
    """Write the tangents of what is seen, from a `signal` on; the motion goes into ``own.seen``."""
    for block in range(entries.rows.shape[0]):
        sums = of_block(entries, slot, block, z, own.lanes, at, groups, triples)
        for i in range(len(triples) // len(groups)):
            seen = element(entries.rows, (block, i))
            put_numbers_from(own.seen, seen * WIDTH, sums[i * len(groups) + len(groups) - 1])
            for group in range(len(groups)):
                _put(layout, beside, signal + seen, group, sums[i * len(groups) + group])


@written_out
def _write(  # type: ignore[no-untyped-def]
    entries, slot, z, own, at, asked, layout, out, row, beside, groups, triples
):
    """Write a row [x1, v1, F, x2, v2, F_d], seen through the matrix in a slot, and its tangents."""
    plant, n, m = out.plant.shape[1], out.numerical.shape[1], out.reference.shape[1]
    signal, lane, width = row * (plant + n + m), layout.motion % WIDTH, len(groups) * WIDTH
    _write_seen(entries, slot, z, own, at, layout, beside, signal, groups, triples)
    for i in range(plant):
        out.plant[row, i] = _lane(own.seen, i, WIDTH, lane)
    for i in range(n):
        out.numerical[row, i] = _lane(own.seen, plant + i, WIDTH, lane)
    for i in range(m):
        out.reference[row, i] = _lane(own.references, asked * m + i, width, layout.motion)
        for group in range(len(groups)):
            tangents = numbers_from(own.references, (asked * m + i) * width + group * WIDTH)
            _put(layout, beside, signal + plant + n + i, group, tangents)


@written_out
def _put_look(step, change, look, slot):  # type: ignore[no-untyped-def]
    """Keep what is seen after a step."""
    look_through(step, change, look)
    put_entries(look.matrix, look.change, look.entries, slot)


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
    out: Outputs,
    tangents: Tangents,
    changes: TangentSteps,
    own: TangentWork,
    layout: Layout,
    like: Any,
    beside: Floats,
) -> None:
    """Execute a program `passes` times or until the rows `out` are full, from z on.

    The tangents of each row [x1, v1, F, x2, v2, F_d] with respect to the parameters follow each other in
    `beside`. Tuples `like` are as long as there are groups of lanes, and these for two and for three rows.
    """
    groups, pairs, triples = like
    width, m, motion, d = len(groups) * WIDTH, looks.k_tot.size, layout.motion, z.size
    s_mask, r_mask = own.samples.size // (2 * m * width) - 1, own.references.size // (m * width) - 1
    s, r, row = count[0], count[1], count[2]
    size, counting, tables = nonlinear.systems.shape[1], looks.forms.shape[0] > 0, steps.work_tables
    held, inputs, as_it_is = d - nonlinear.weight.size - 2 * m, (d - size) * width, changes.filled.size
    at, to, number, arc, single = 0, d * width, -1, -1, True
    begin_tangents(nonlinear, work, tangents, z, own.halves[0])
    _move(own.lanes, at + size * width, own.lanes, to + size * width, inputs)
    for p in range(passes):
        later, until = min(p, 1), -1
        for e in range(operations.what.size):
            what, k, span = operations.what[e], operations.length[later, e], operations.span[later, e]
            last, trying = operations.last[later, e], -1
            if e > until:
                single = last < e
                trying = k if single else operations.span[later, last]
            while trying >= 0:
                number, arc = set_of(nonlinear.bits, work.modes), trying
                slot = _slot(nonlinear, steps, tangents, changes, own, number, arc)
                _seen(changes.steps, slot, z, own.lanes, at, own.lanes, to, groups, pairs)
                copy_into(work.end, z)
                for j in range(size):
                    work.end[j] = _lane(own.lanes, j, width, to + motion)
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
                _move(own.lanes, at + size * width, own.lanes, to + size * width, inputs)
            elif k >= 0 and not within:
                at, to = to, at
                copy_into(z, work.end)
                if counting:
                    count_work(nonlinear, tables, number, arc, work.products, work.before, work.sums)
            slot = as_it_is
            if within:
                slot = _slot(nonlinear, steps, tangents, changes, own, number, span)
            used, asked = (s - operations.sample[e]) & s_mask, (r - operations.reference[e]) & r_mask
            if what == REFERENCE:
                begin = held * width
                _move(own.samples, used * 2 * m * width, own.lanes, at + begin, 2 * m * width)
                _move(own.lanes, at + begin, own.lanes, to + begin, 2 * m * width)
                for i in range(2 * m):
                    z[held + i] = _lane(own.samples, used * 2 * m + i, width, motion)
                ring = (r & r_mask) * m * width
                _seen(changes.reference, 0, z, own.lanes, at, own.references, ring, groups, pairs)
                r += 1
            elif what == MOTOR:
                begin = size * width
                _command(looks.k_tot, tangents.k_tot, counting, motion, own, used, asked, at + begin, width)
                _move(own.lanes, at + begin, own.lanes, to + begin, (held - size) * width)
                for i in range(size, held):
                    z[i] = _lane(own.lanes, i, width, at + motion)
            elif what == SAMPLE:
                ring = (s & s_mask) * 2 * m * width
                _seen(changes.sample.entries, slot, z, own.lanes, at, own.samples, ring, groups, pairs)
                _add(tangents.bias, own.samples, ring)
                s += 1
            elif what == OUTPUT:
                _write(
                    changes.row.entries, slot, z, own, at, asked, layout, out, row, beside, groups, triples
                )
                if counting and within:
                    count_work(nonlinear, tables, number, span, work.products, work.before, work.sums)
                    write_work_within(work.sums, out.work, row)
                elif counting:
                    write_work(looks.forms, work.sums, z, out.work[row])
                row += 1
                if row == out.plant.shape[0]:
                    break
    if at:
        _move(own.lanes, at, own.lanes, 0, d * width)
    count[0], count[1], count[2] = s, r, row
