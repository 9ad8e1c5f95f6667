"""Advance a loop and its tangents where forces of laws change within a step, compiled.

The motion is that of ``nonlinear.advance``; its tangents follow it step by step.
"""

from __future__ import annotations

from rthm_core.compiled import inlined, whole
from rthm_core.engine.nonlinear.advance import (
    MOST_SWITCHES,
    REST_OF_ROUNDING,
    SHORTEST_STEP,
    begin_step,
    count_step,
    end_step,
    following,
    halvings_of,
    shorter,
    try_step,
)
from rthm_core.engine.nonlinear.forces import forces
from rthm_core.engine.nonlinear.packed import prepare
from rthm_core.engine.nonlinear.steps import ORDERS
from rthm_core.engine.nonlinear.switch import first_left, product
from rthm_core.engine.tangents.advance import jump, rates, shift_of
from rthm_core.engine.tangents.implicit import begin_polynomial, force_tangents, solve_forces
from rthm_core.engine.tangents.kernel import move, see_tangents
from rthm_core.engine.tangents.polynomial import STAGES, find_influence, make_changes, through_series
from rthm_core.engine.tangents.steps import copy_numbers
from rthm_core.physical.switching import next_mode
from rthm_core.simd import everywhere, numbers, put_numbers


@inlined
def refresh(nonlinear, tangents, work, own, z, t, half, motion, groups):  # type: ignore[no-untyped-def]
    """Tangents of the forces at z, of which one lane is the forces themselves."""
    first, dz = z.size - work.force.size, own.halves[half]
    force_tangents(nonlinear, tangents, own.ask, z, t, work.modes, dz, groups)
    for j in range(first, z.size):
        own.lanes[(half * dz.shape[0] + j) * own.width + motion] = z[j]


@inlined
def _mixed(modes):  # type: ignore[no-untyped-def]
    """All modes as one number."""
    mixed = 0
    for row in range(modes.size):
        mixed = 4 * mixed + modes[row]
    return mixed


@inlined
def _feel(nonlinear, own, system, change, length, half, whole):  # type: ignore[no-untyped-def]
    """Tangents of what is felt after each third of a step of any length, into ``own.felt``."""
    through_series(
        system,
        change,
        nonlinear.fastest,
        length,
        1.0,
        whole,
        own.halves[half],
        own.one,
        own.other,
        own.column,
    )
    for stage in range(STAGES):
        for i in range(nonlinear.felt.size):
            for group in range(own.felt.shape[1]):
                tangent = numbers(own.column, (stage, nonlinear.felt[i], group))
                put_numbers(own.felt, (stage * nonlinear.felt.size + i, group), tangent)


@whole
def follow(  # type: ignore[no-untyped-def]
    nonlinear, steps, tangents, changes, work, own, number, slot, half, t, length, motion, groups, pairs
):
    """Tangents of the forces over the step just found from those at its start, in a half of them."""
    g, dwhole = work.force.size, own.halves[half]
    first, size = own.now.size - g, dwhole.shape[0] * own.width
    begin_polynomial(dwhole, first, g, groups)
    if slot < changes.filled.size - 1:
        if not changes.filled[slot]:
            make_changes(nonlinear, steps, tangents, changes, own, number, slot, length)
        see_tangents(
            changes.stages, slot, work.whole, own.lanes, half * size, own.felt_lanes, 0, groups, pairs
        )
    else:
        _feel(nonlinear, own, nonlinear.systems[number], tangents.systems[number], length, half, work.whole)
        find_influence(steps.matrices[slot], nonlinear.felt, g, changes.influence[slot])
    solve_forces(nonlinear, tangents, work, own, slot, changes.influence, half, t, length / 3.0, groups)
    for row in range(first, dwhole.shape[0]):
        own.lanes[half * size + row * own.width + motion] = work.whole[row]


@inlined
def _end_forces(work, own, half, motion, groups):  # type: ignore[no-untyped-def]
    """Tangents of the forces at the end of a step, into the other half."""
    g, forces, halves = work.force.size, own.forces, own.halves
    first = own.now.size - g
    for j in range(g):
        for group in range(len(groups)):
            tangent = numbers(forces, ((STAGES - 1) * g + j, group))
            put_numbers(halves, (1 - half, first + j, group), tangent)
        own.lanes[((1 - half) * halves.shape[1] + first + j) * own.width + motion] = work.g[STAGES, j]


@inlined
def end_tangents(changes, work, own, slot, half, motion, groups, pairs):  # type: ignore[no-untyped-def]
    """Tangents of z at the end of a step of a kept length, into the other half."""
    size = own.halves.shape[1] * own.width
    to = (1 - half) * size
    see_tangents(changes.after, slot, work.whole, own.lanes, half * size, own.lanes, to, groups, pairs)
    _end_forces(work, own, half, motion, groups)


@inlined
def _forces_at(work, own, half, share, third, z):  # type: ignore[no-untyped-def]
    """Forces at a share of a step into z, their rates into ``own.rate``, and their tangents into the other
    half, from the polynomials.
    """
    g, at = work.force.size, share * STAGES
    first = z.size - g
    for j in range(first, z.size):
        value = rate = 0.0
        for order in range(ORDERS - 1, -1, -1):
            rate = rate * at + value
            value = value * at + work.whole[j + order * g]
        z[j], own.rate[j] = value, rate / third
        for group in range(own.shift.shape[0]):
            tangent = everywhere(0.0)
            for order in range(ORDERS - 1, -1, -1):
                tangent = tangent * at + numbers(own.halves, (half, j + order * g, group))
            put_numbers(own.halves, (1 - half, j, group), tangent)


@inlined
def _part_way(nonlinear, tangents, work, own, number, length, share, half):  # type: ignore[no-untyped-def]
    """Tangents of y after a share of a step, into the other half."""
    end = own.column[:1]
    through_series(
        nonlinear.systems[number], tangents.systems[number], nonlinear.fastest, length, share,
        work.whole, own.halves[half], own.one, own.other, end,
    )  # fmt: skip
    copy_numbers(end[0], own.halves[1 - half], end.shape[1])


@inlined
def _cross(nonlinear, tangents, work, own, number, law, half, z, t):  # type: ignore[no-untyped-def]
    """Let a law switch at `t`, where it leaves its mode, and the tangents jump."""
    dz, mode = own.halves[half][: z.size], work.modes[law]
    rates(nonlinear, number, z, own.rate)
    shift_of(nonlinear, tangents, number, law, mode, z, dz, own.rate, own.shift)
    hold = product(nonlinear.holds[number, law], z)
    work.modes[law] = next_mode(nonlinear.laws, nonlinear.n, law, mode, z, hold)
    then = begin_step(nonlinear, z, t, work.modes)
    jump(nonlinear, then, law, work.modes[law], z, dz, own.rate, own.shift)


@whole
def advance_beside(  # type: ignore[no-untyped-def]
    nonlinear, steps, packed, tangents, changes, work, own, z, k, t, half, motion, groups, pairs
):
    """Advance z over length `k`, from time `t` (s) on, and its tangents in a half of ``own.halves``; returns
    the half in which they are then.
    """
    size, lengths, kinds = nonlinear.systems.shape[1], steps.lengths, steps.lengths.size
    whole, first, lanes = lengths[k], z.size - work.force.size, own.halves.shape[1] * own.width
    halvings, done, switches = halvings_of(lengths, packed, k, 0, work.pace[0]), 0.0, 0
    length, stale = lengths[k + halvings * packed.whole], False
    while done < whole:
        before = _mixed(work.modes)
        number = begin_step(nonlinear, z, t + done, work.modes)
        stale = stale or before != _mixed(work.modes)
        slot = number * kinds + k + halvings * packed.whole if halvings >= 0 else packed.filled.size - 1
        prepare(nonlinear, steps, packed, number, slot, length)
        if not try_step(nonlinear, packed, work, slot, z, t + done, length) and length > SHORTEST_STEP:
            halvings, length = shorter(lengths, packed, k, halvings, length, work.pace[0])
            continue
        law, share, terms = -1, 1.0, 0
        if switches < MOST_SWITCHES:
            law, share, terms = first_left(nonlinear, work, number, z, length)
        if stale:
            refresh(nonlinear, tangents, work, own, z, t + done, half, motion, groups)
        follow(
            nonlinear, steps, tangents, changes, work, own, number, slot, half, t + done, length, motion,
            groups, pairs,
        )  # fmt: skip
        held = half * lanes + size * own.width
        move(own.lanes, held, own.lanes, (1 - half) * lanes + size * own.width, (first - size) * own.width)
        if law < 0 and halvings >= 0:
            end_tangents(changes, work, own, slot, half, motion, groups, pairs)
        else:
            _part_way(nonlinear, tangents, work, own, number, length, share, half)
            _end_forces(work, own, half, motion, groups)
        if law >= 0 or not count_step(nonlinear, steps.work_tables, work, number, k, halvings):
            end_step(nonlinear, work, number, z, law, share, terms, length)
        for i in range(size):
            z[i] = work.end[i]
        done = done + share * length
        if law >= 0:
            _forces_at(work, own, half, share, length / 3.0, z)
            _cross(nonlinear, tangents, work, own, number, law, 1 - half, z, t + done)
            switches += 1
        half, stale = 1 - half, law >= 0
        for i in range(size):
            own.lanes[half * lanes + i * own.width + motion] = z[i]
        if law >= 0:
            halvings, length = -1, whole - done
            continue
        if whole - done <= REST_OF_ROUNDING * whole:
            break
        halvings, length = following(lengths, packed, k, halvings, length, whole - done, work.pace[0])
    forces(nonlinear, z, t + whole, work.modes, z[first:])
    if stale:
        refresh(nonlinear, tangents, work, own, z, t + whole, half, motion, groups)
    return half
