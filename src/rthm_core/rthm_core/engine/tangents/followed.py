"""The compiled kernel of a loop and its tangents where forces of laws change within a step: what
`nonlinear.kernel` runs, with derivatives beside it.

The motion of an arc is found first. Its tangents follow from one linear system, and what is seen on its way
from them; the motion is a lane of them there, too.
"""

from __future__ import annotations

from typing import Any

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, inlined, unrolled
from rthm_core.engine.nonlinear.advance import Work
from rthm_core.engine.nonlinear.arc import begin_arc, count_within, end_arc, part_of
from rthm_core.engine.nonlinear.forces import wire_forces
from rthm_core.engine.nonlinear.kernel import Looks, add_moments, write_work, write_work_within
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.operations import Operations
from rthm_core.engine.nonlinear.packed import Packed, prepare
from rthm_core.engine.nonlinear.steps import ORDERS, Steps
from rthm_core.engine.tangents.changes import Tangents
from rthm_core.engine.tangents.following import FollowedSteps, FollowedWork
from rthm_core.engine.tangents.kernel import (
    Layout,
    add_bias,
    lane_of,
    move,
    put_command,
    see_tangents,
    write,
)
from rthm_core.engine.tangents.polynomial import make_changes
from rthm_core.engine.tangents.within import advance_beside, end_tangents, follow, refresh
from rthm_core.lent import lent
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import numbers, put_numbers


@inlined
def _scaled(own, half, first, g, share):  # type: ignore[no-untyped-def]
    """Tangents of the coefficients of the forces over a leading `share` of an arc, into the last part of
    ``own.halves``; and those of the forces at its end, into the other half.
    """
    last = own.halves.shape[0] - 1
    for j in range(first, first + g):
        for group in range(own.halves.shape[2]):
            total = numbers(own.halves, (half, j, group))
            put_numbers(own.halves, (last, j, group), total)
            factor, unit = share, (ORDERS - 1.0)
            for order in range(1, ORDERS):
                part = numbers(own.halves, (half, j + order * g, group)) * factor
                put_numbers(own.halves, (last, j + order * g, group), part)
                total += part * unit
                factor *= share
                unit *= ORDERS - 1.0
            put_numbers(own.halves, (1 - half, j, group), total)


@called
def _within(  # type: ignore[no-untyped-def]
    nonlinear, steps, packed, tangents, changes, work, own, number, k, span, half, motion, groups, pairs
):
    """Tangents of z a length `span` after the beginning of an arc over length `k`, into the other half, and z
    itself into ``own.now``.
    """
    slot = number * steps.lengths.size + span
    if not changes.filled[slot]:
        prepare(nonlinear, steps, packed, number, slot, steps.lengths[span])
        make_changes(nonlinear, steps, tangents, changes, own, number, slot, steps.lengths[span])
    g, share = work.force.size, steps.lengths[span] / steps.lengths[k]
    first, size = own.now.size - g, own.halves.shape[1] * own.width
    part_of(work.whole, g, share, work.part)
    _scaled(own, half, first, g, share)
    last = (own.halves.shape[0] - 1) * size
    see_tangents(changes.after, slot, work.part, own.lanes, last, own.lanes, (1 - half) * size, groups, pairs)
    for j in range(own.now.size):
        own.now[j] = lane_of(own.lanes, j, own.width, (1 - half) * size + motion)


@unrolled
@compiled_in_place
def run_followed(
    nonlinear: Nonlinear,
    steps: Steps,
    packed: Packed,
    work: Work,
    looks: Looks,
    operations: Operations,
    count: Integers,
    z: Floats,
    passes: int,
    rows: int,
    counted: Floats,
    tangents: Tangents,
    changes: FollowedSteps,
    own: FollowedWork,
    layout: Layout,
    like: Any,
    beside: Floats,
) -> None:
    """Execute a program `passes` times or until so many `rows` are written, from z on; see `run_tangents`."""
    nonlinear, steps, packed, work = lent(nonlinear), lent(steps), lent(packed), lent(work)
    tangents, changes, own = lent(tangents), lent(changes), lent(own)
    groups, pairs, triples = like
    width, m, motion, d = own.width, looks.k_tot.size, layout.motion, z.size
    s_mask, r_mask = own.samples.size // (2 * m * width) - 1, own.references.size // (m * width) - 1
    s, r, row = count[0], count[1], count[2]
    size, counting, lengths = nonlinear.systems.shape[1], looks.forms.shape[0] > 0, steps.lengths
    held, inputs = d - nonlinear.weight.size - 2 * m, (d - nonlinear.weight.size - size) * width
    part, half, number, arc, within, begun = own.halves.shape[1] * width, 0, -1, -1, False, False
    wire_forces(nonlinear, z, z)
    refresh(nonlinear, tangents, work, own, z, 0.0, half, motion, groups)
    for p in range(passes):
        later, until = min(p, 1), -1
        for e in range(operations.what.size):
            what, k, span = operations.what[e], operations.length[later, e], operations.span[later, e]
            last, now = operations.last[later, e], operations.time[e] + p * operations.period
            at, to = half * part, (1 - half) * part
            if e > until and last >= e:
                arc = operations.span[later, last]
                begin = now * 1e-9 - (lengths[span] if span >= 0 else 0.0)
                number = begin_arc(nonlinear, steps, packed, work, z, arc, begin)
                until = last if number >= 0 else -1
                if number >= 0:
                    slot = number * lengths.size + arc
                    follow(
                        nonlinear, steps, tangents, changes, work, own, number, slot, half, begin,
                        lengths[arc], motion, groups, pairs,
                    )  # fmt: skip
                    move(own.lanes, at + size * width, own.lanes, to + size * width, inputs)
                    begun = False
            if k >= 0 and e > until:
                since = now * 1e-9 - lengths[k]
                half = advance_beside(
                    nonlinear, steps, packed, tangents, changes, work, own, z, k, since, half, motion, groups,
                    pairs,
                )  # fmt: skip
                add_moments(looks.forms, work.moments, work.sums)
                within = False
            elif k >= 0 and span == arc:
                slot = number * lengths.size + arc
                end_tangents(changes, work, own, slot, half, motion, groups, pairs)
                end_arc(nonlinear, steps, work, number, arc, z)
                half, within = 1 - half, False
            elif k >= 0:
                if not begun:
                    move(own.lanes, at, own.lanes, 2 * part, d * width)
                    begun = True
                _within(
                    nonlinear, steps, packed, tangents, changes, work, own, number, arc, span, half, motion,
                    groups, pairs,
                )  # fmt: skip
                within = True
            at = half * part
            used, asked = (s - operations.sample[e]) & s_mask, (r - operations.reference[e]) & r_mask
            here, seen = ((1 - half) * part, own.now) if within else (at, z)
            if what == MOTOR:
                put_command(
                    looks.k_tot, tangents.k_tot, counting, motion, own, used, asked, at + size * width, width
                )
                for i in range(size, held):
                    z[i] = lane_of(own.lanes, i, width, at + motion)
                wire_forces(nonlinear, z, z)
                if nonlinear.wires.dof.size:
                    refresh(nonlinear, tangents, work, own, z, now * 1e-9, half, motion, groups)
                within = False
            elif what == REFERENCE:
                move(own.samples, used * 2 * m * width, own.lanes, at + held * width, 2 * m * width)
                for i in range(2 * m):
                    z[held + i] = lane_of(own.samples, used * 2 * m + i, width, motion)
                ring = (r & r_mask) * m * width
                see_tangents(changes.reference, 0, z, own.lanes, at, own.references, ring, groups, pairs)
                r += 1
                within = False
            elif what == SAMPLE:
                ring = (s & s_mask) * 2 * m * width
                see_tangents(changes.sample, 0, seen, own.lanes, here, own.samples, ring, groups, pairs)
                add_bias(tangents.bias, own.samples, ring)
                s += 1
            elif what == OUTPUT:
                write(changes.row, 0, seen, own, here, asked, layout, m, row, beside, groups, pairs, triples)
                if counting and e <= until and 0 <= span != arc:
                    count_within(nonlinear, steps, work, number, span)
                    write_work_within(work.sums, counted, row)
                elif counting:
                    write_work(looks.forms, work.sums, z, counted[row])
                row += 1
                if row == rows:
                    break
    if half:
        move(own.lanes, part, own.lanes, 0, d * width)
    count[0], count[1], count[2] = s, r, row
