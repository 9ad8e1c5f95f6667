"""The compiled kernel of a loop and its tangents: what `nonlinear.kernel` runs, with derivatives beside it.

Clocks do not depend on physics, so that both follow one program. The motion is a lane of its tangents (see
`Tangents`), and is advanced with them, an arc at once where nothing switches in it; a step in which a law
switches is made by itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, copy_into, inlined
from rthm_core.engine.nonlinear.advance import Work, set_of
from rthm_core.engine.nonlinear.arc import sticks_on
from rthm_core.engine.nonlinear.event_free import nothing_switches
from rthm_core.engine.nonlinear.kernel import Looks, Outputs, add_moments, write_work
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.operations import Operations
from rthm_core.engine.nonlinear.steps import Steps, fill
from rthm_core.engine.tangents.advance import TangentWork, advance_tangents, begin_tangents, change_of_step
from rthm_core.engine.tangents.changes import Tangents
from rthm_core.engine.tangents.entries import Entries
from rthm_core.engine.tangents.steps import by_entries, put_entries
from rthm_core.engine.worked import worked
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import WIDTH, numbers, numbers_from, put_numbers, put_numbers_from


class TangentSteps(NamedTuple):
    """Matrices of steps, which of them are there, and what is seen of [y, held]."""

    steps: Entries
    filled: Integers
    sample: Entries
    force: Entries
    reference: Entries


class Layout(NamedTuple):
    """Number of parameters, those before each group (Q,), and the lane of the motion."""

    parameters: int
    before: Integers
    motion: int


@inlined
def _lane(lanes, row, groups, motion):  # type: ignore[no-untyped-def]
    """Element of the motion whose tangents these are."""
    return lanes[np.uint64(row * len(groups) * WIDTH + motion)]


@inlined
def _move(source, begin, target, to, count):  # type: ignore[no-untyped-def]
    """Copy so many numbers, which are whole SIMD values."""
    for i in range(0, count, WIDTH):
        put_numbers_from(target, to + i, numbers_from(source, begin + i))


@inlined
def _hold(lanes, at, to, way, begin, count):  # type: ignore[no-untyped-def]
    """Let the tangents of inputs that changed be those at the end of a step and on the way, too."""
    _move(lanes, at + begin, lanes, to + begin, count)
    _move(lanes, at + begin, lanes, way + begin, count)


@inlined
def _add(bias, lanes, begin, groups):  # type: ignore[no-untyped-def]
    """Add the tangents of a bias."""
    for i in range(bias.shape[0]):
        for group in range(len(groups)):
            place = begin + (i * len(groups) + group) * WIDTH
            put_numbers_from(lanes, place, numbers_from(lanes, place) + numbers(bias, (i, group)))


@inlined
def _command(k_tot, change, counting, motion, own, used, asked, to, groups):  # type: ignore[no-untyped-def]
    """Tangents of a command from a sample and a reference: of its two parts where work is counted."""
    m, width = k_tot.size, len(groups) * WIDTH
    for i in range(m):
        compliance = 1.0 / k_tot[i]
        part = _lane(own.references, asked * m + i, groups, motion) * compliance
        for group in range(len(groups)):
            lane = group * WIDTH
            sample = numbers_from(own.samples, (used * 2 * m + i) * width + lane)
            reference = numbers_from(own.references, (asked * m + i) * width + lane)
            beside = (reference - numbers(change, (i, group)) * part) * compliance
            if counting:
                put_numbers_from(own.lanes, to + i * width + lane, sample)
                put_numbers_from(own.lanes, to + (m + i) * width + lane, beside)
            else:
                put_numbers_from(own.lanes, to + i * width + lane, sample + beside)


@inlined
def _put(lanes, row, layout, beside, place, groups):  # type: ignore[no-untyped-def]
    """Write the tangents of one signal; lanes beyond the parameters are overwritten by what follows."""
    for group in range(len(groups)):
        begin = place * layout.parameters + layout.before[np.uint64(group)]
        put_numbers_from(beside, begin, numbers_from(lanes, (row * len(groups) + group) * WIDTH))


@inlined
def _write(places, own, view, asked, layout, out, row, beside, groups):  # type: ignore[no-untyped-def]
    """Write a row [x1, v1, F, x2, v2, F_d] and its tangents; `view` is where those of [y, held, g] are."""
    plant, m, motion = out.plant.shape[1], out.reference.shape[1], layout.motion
    place, first = row * (places.size + 2 * m), view // (len(groups) * WIDTH)
    for i in range(plant - m):
        out.plant[row, i] = own.now[places[i]]
        _put(own.lanes, first + places[i], layout, beside, place + i, groups)
    for i in range(m):
        out.plant[row, plant - m + i] = _lane(own.force, i, groups, motion)
        _put(own.force, i, layout, beside, place + plant - m + i, groups)
    for i in range(plant - m, places.size):
        out.numerical[row, i - plant + m] = own.now[places[i]]
        _put(own.lanes, first + places[i], layout, beside, place + m + i, groups)
    for i in range(m):
        out.reference[row, i] = _lane(own.references, asked * m + i, groups, motion)
        _put(own.references, asked * m + i, layout, beside, place + places.size + m + i, groups)


@called
def _prepare(nonlinear, steps, tangents, changes, own, number, k, slot):  # type: ignore[no-untyped-def]
    """Make a step over length `k`."""
    if not steps.filled[slot]:
        fill(nonlinear.systems[number], nonlinear.fastest, steps, slot, steps.lengths[k])
        steps.filled[slot] = 1
    change_of_step(nonlinear, steps, tangents, own, number, k)
    put_entries(steps.matrices[slot, 0], own.change, changes.steps, slot)
    changes.filled[slot] = 1


@inlined
def _after(nonlinear, steps, tangents, changes, own, number, k, z, at, to, motion, groups, end):  # type: ignore[no-untyped-def]
    """Motion `end` a length `k` after z, and its tangents from `to` on, of those from `at` on."""
    slot, size = number * steps.lengths.size + k, nonlinear.systems.shape[1]
    if not changes.filled[slot]:
        _prepare(nonlinear, steps, tangents, changes, own, number, k, slot)
    by_entries(changes.steps, slot, z, own.lanes, at, groups, own.lanes, to)
    for i in range(size):
        end[i] = own.lanes[np.uint64(to + i * len(groups) * WIDTH + motion)]
    for j in range(size, z.size):
        end[j] = z[j]


@inlined
def _goes_on(nonlinear, work, number, z):  # type: ignore[no-untyped-def]
    """Whether nothing switches between z and ``work.end``."""
    return nothing_switches(
        nonlinear.systems, nonlinear.holds, number, nonlinear.laws.numbers, nonlinear.n,
        nonlinear.laws.breakaway, z, work.modes, work.end,
    )  # fmt: skip


@inlined
def _work_over(nonlinear, steps, number, k, z):  # type: ignore[no-untyped-def]
    """Work (8,), a SIMD value, over length `k` from z on."""
    tables = steps.work_tables
    return worked(tables, number * (tables.shape[0] // nonlinear.systems.shape[0]) + k, z)


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
    groups: tuple[int, ...],
    layout: Layout,
    beside: Floats,
) -> None:
    """Execute a program `passes` times or until the rows `out` are full, from z on.

    The tangents of each row [x1, v1, F, x2, v2, F_d] with respect to the parameters follow each other in
    `beside`, which has `WIDTH` numbers to spare. The tuple `groups` is as long as there are groups of lanes.
    """
    width, m, motion, d = len(groups) * WIDTH, looks.k_tot.size, layout.motion, z.size
    s_mask, r_mask = own.samples.size // (2 * m * width) - 1, own.references.size // (m * width) - 1
    s, r, row = count[0], count[1], count[2]
    size, counting, table = nonlinear.systems.shape[1], looks.forms.shape[0] > 0, steps.work_tables.shape[0]
    held, inputs = d - nonlinear.weight.size - 2 * m, (d - size) * width
    at, to, way, number, arc = 0, d * width, 2 * d * width, -1, -1
    view = at
    begin_tangents(nonlinear, work, tangents, z, own.three[0])
    _hold(own.lanes, at, to, way, size * width, inputs)
    copy_into(own.now, z)
    for p in range(passes):
        later, until = min(p, 1), -1
        for e in range(operations.what.size):
            what, k, span = operations.what[e], operations.length[later, e], operations.span[later, e]
            last = operations.last[later, e]
            if e > until and last >= e:
                number, arc = set_of(nonlinear.bits, work.modes), operations.span[later, last]
                _after(
                    nonlinear, steps, tangents, changes, own, number, arc, z, at, to, motion, groups, work.end
                )
                good = _goes_on(nonlinear, work, number, z) and sticks_on(
                    nonlinear, number, work.modes, z, work.end
                )
                until = last if good else -1
                copy_into(work.before, work.sums)
            whole = e <= until
            if k >= 0 and whole and span != arc:
                _after(
                    nonlinear, steps, tangents, changes, own, number, span, z, at, way, motion, groups,
                    own.now,
                )  # fmt: skip
                view = way
                if table:
                    added = _work_over(nonlinear, steps, number, span, z)
                    put_numbers(work.sums, (), numbers(work.before, ()) + added)
            elif k >= 0:
                good, step = whole, arc
                if not whole:
                    number, step = set_of(nonlinear.bits, work.modes), k
                    _after(
                        nonlinear, steps, tangents, changes, own, number, k, z, at, to, motion, groups,
                        work.end,
                    )  # fmt: skip
                    good = _goes_on(nonlinear, work, number, z)
                    copy_into(work.before, work.sums)
                if good:
                    if table:
                        added = _work_over(nonlinear, steps, number, step, z)
                        put_numbers(work.sums, (), numbers(work.before, ()) + added)
                    at, to = to, at
                    copy_into(z, work.end)
                else:
                    since = (operations.time[e] + p * operations.period) * 1e-9 - steps.lengths[k]
                    half = at // (d * width)
                    advance_tangents(
                        nonlinear, steps, work, tangents, own, z, own.three[half], own.three[1 - half], k,
                        since,
                    )  # fmt: skip
                    add_moments(looks.forms, work.moments, work.sums)
                    for j in range(d):
                        own.lanes[at + j * width + motion] = z[j]
                    _hold(own.lanes, at, to, way, size * width, inputs)
                view = at
                copy_into(own.now, z)
            used, asked = (s - operations.sample[e]) & s_mask, (r - operations.reference[e]) & r_mask
            if what == REFERENCE:
                _move(own.samples, used * 2 * m * width, own.lanes, at + held * width, 2 * m * width)
                _hold(own.lanes, at, to, way, held * width, 2 * m * width)
                for i in range(2 * m):
                    z[held + i] = own.now[held + i] = _lane(own.samples, used * 2 * m + i, groups, motion)
                ring = (r & r_mask) * m * width
                by_entries(changes.reference, 0, z, own.lanes, at, groups, own.references, ring)
                r += 1
            elif what == MOTOR:
                begin = size * width
                _command(looks.k_tot, tangents.k_tot, counting, motion, own, used, asked, at + begin, groups)
                _hold(own.lanes, at, to, way, begin, held * width - begin)
                for i in range(size, held):
                    z[i] = own.now[i] = own.lanes[at + i * width + motion]
            elif what == SAMPLE:
                ring = (s & s_mask) * 2 * m * width
                by_entries(changes.sample, 0, own.now, own.lanes, view, groups, own.samples, ring)
                _add(tangents.bias, own.samples, ring, groups)
                s += 1
            elif what == OUTPUT:
                by_entries(changes.force, 0, own.now, own.lanes, view, groups, own.force, 0)
                _write(looks.motion, own, view, asked, layout, out, row, beside, groups)
                if counting:
                    write_work(looks.forms, work.sums, own.now, out.work[row])
                row += 1
                if row == out.plant.shape[0]:
                    break
    if at:
        _move(own.lanes, at, own.lanes, 0, d * width)
    count[0], count[1], count[2] = s, r, row
