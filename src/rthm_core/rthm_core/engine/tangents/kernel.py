"""The compiled kernel of a loop and its tangents: what `nonlinear.kernel` runs, with derivatives beside it.

Clocks do not depend on physics, so that both follow one program. The motion is a lane of its tangents (see
`Tangents`), and is advanced with them; a step in which a law switches is made by itself.
"""

from __future__ import annotations

from typing import NamedTuple

from rthm_core.compiled import Floats, Integers, compiled_in_place, copy_into, inlined
from rthm_core.engine.nonlinear.advance import Work, set_of
from rthm_core.engine.nonlinear.event_free import nothing_switches
from rthm_core.engine.nonlinear.kernel import (
    Looks,
    Outputs,
    add_moments,
    write_work,
)
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.operations import Operations
from rthm_core.engine.nonlinear.steps import Steps
from rthm_core.engine.tangents.advance import TangentWork, advance_tangents, change_of_step
from rthm_core.engine.tangents.changes import Pairs, Tangents
from rthm_core.engine.tangents.steps import by_pairs, copy_numbers, put_pairs
from rthm_core.engine.worked import worked
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import WIDTH, numbers, put_numbers, put_numbers_from


class TangentSteps(NamedTuple):
    """Matrices of steps, which of them are there, and what is seen of [y, held]."""

    steps: Pairs
    filled: Integers
    sample: Pairs
    force: Pairs
    reference: Pairs


@inlined
def _see(pairs, z, dz, groups, out):  # type: ignore[no-untyped-def]
    by_pairs(pairs.columns, pairs.values, pairs.changes, 0, z, dz, groups, out.shape[0], out)


@inlined
def _add(bias, out, groups):  # type: ignore[no-untyped-def]
    for i in range(out.shape[0]):
        for group in range(len(groups)):
            put_numbers(out, (i, group), numbers(out, (i, group)) + numbers(bias, (i, group)))


@inlined
def _lane(dz, i, motion):  # type: ignore[no-untyped-def]
    """Element of the motion whose tangents these are."""
    return dz[i, motion[0], motion[1]]


@inlined
def _command(k_tot, change, counting, motion, dsample, dreference, out, groups):  # type: ignore[no-untyped-def]
    """Tangents of a command: of its two parts where work is counted."""
    m = k_tot.size
    for i in range(m):
        compliance = 1.0 / k_tot[i]
        part = _lane(dreference, i, motion) * compliance
        for group in range(len(groups)):
            beside = (numbers(dreference, (i, group)) - part * numbers(change, (i, group))) * compliance
            if counting:
                put_numbers(out, (i, group), numbers(dsample, (i, group)))
                put_numbers(out, (m + i, group), beside)
            else:
                put_numbers(out, (i, group), numbers(dsample, (i, group)) + beside)


@inlined
def _hold(dz, after, first, count, groups):  # type: ignore[no-untyped-def]
    """Let inputs that changed be those after the following step, too."""
    for i in range(first, first + count):
        for group in range(len(groups)):
            put_numbers(after, (i, group), numbers(dz, (i, group)))


@inlined
def _put(dz, i, beside, place, parameters, groups):  # type: ignore[no-untyped-def]
    """Write the tangents of one signal; lanes beyond the parameters are overwritten by the next."""
    for group in range(len(groups)):
        put_numbers_from(beside, place * parameters + group * WIDTH, numbers(dz, (i, group)))


@inlined
def _write(  # type: ignore[no-untyped-def]
    places, motion, dz, dforce, dreference, out, row, beside, parameters, groups
):
    """Write a row [x1, v1, F, x2, v2, F_d] and its tangents."""
    m, plant = dforce.shape[0], out.plant.shape[1]
    place = row * (places.size + 2 * m)
    for i in range(plant - m):
        out.plant[row, i] = _lane(dz, places[i], motion)
        _put(dz, places[i], beside, place + i, parameters, groups)
    for i in range(m):
        out.plant[row, plant - m + i] = _lane(dforce, i, motion)
        _put(dforce, i, beside, place + plant - m + i, parameters, groups)
    for i in range(plant - m, places.size):
        out.numerical[row, i - plant + m] = _lane(dz, places[i], motion)
        _put(dz, places[i], beside, place + m + i, parameters, groups)
    for i in range(m):
        out.reference[row, i] = _lane(dreference, i, motion)
        _put(dreference, i, beside, place + places.size + m + i, parameters, groups)


@inlined
def _event_free(  # type: ignore[no-untyped-def]
    nonlinear, steps, work, tangents, changes, own, number, k, y, dz, after, end, groups
):
    """Tangents `after` a step from dz on, with the motions `end` and y as lanes; whether it may be taken,
    which it may not where anything switches.
    """
    pairs, slot = changes.steps, number * steps.lengths.size + k
    if not steps.filled[slot]:
        return False
    if not changes.filled[slot]:
        change_of_step(nonlinear, steps, tangents, own, number, k)
        put_pairs(steps.matrices[slot, 0], own.change, pairs, slot)
        changes.filled[slot] = 1
    by_pairs(
        pairs.columns, pairs.values, pairs.changes, slot, y, dz, groups, nonlinear.systems.shape[1], after
    )
    if not nothing_switches(
        nonlinear.systems, nonlinear.holds, number, nonlinear.laws.numbers, nonlinear.n,
        nonlinear.laws.breakaway, y, work.modes, end,
    ):  # fmt: skip
        return False
    if steps.work_tables.shape[0]:
        put_numbers(work.sums, (), numbers(work.sums, ()) + worked(steps.work_tables, slot, y))
    return True


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
    parameters: int,
    beside: Floats,
) -> None:
    """Execute a program `passes` times or until the rows `out` are full, from z on.

    The tangents of each row [x1, v1, F, x2, v2, F_d] with respect to so many `parameters` follow each other
    in `beside`, which has `WIDTH` numbers to spare. The tuple `groups` is as long as there are groups of
    lanes.
    """
    dz, after, dsamples, dreferences = own.dz, own.after, own.samples, own.references
    s_mask, r_mask = dsamples.shape[0] - 1, dreferences.shape[0] - 1
    s, r, row = count[0], count[1], count[2]
    size, m, motion = nonlinear.systems.shape[1], looks.k_tot.size, divmod(parameters, WIDTH)
    held = nonlinear.systems.shape[2] - nonlinear.weight.size - 2 * m
    counting = looks.forms.shape[0] > 0
    y, end = dz[:, motion[0], motion[1]], after[:, motion[0], motion[1]]
    for p in range(passes):
        later = min(p, 1)
        for e in range(operations.what.size):
            what, k = operations.what[e], operations.length[later, e]
            if k >= 0:
                number = set_of(nonlinear.bits, work.modes)
                if _event_free(
                    nonlinear, steps, work, tangents, changes, own, number, k, y, dz, after, end, groups
                ):
                    dz, after, y, end = after, dz, end, y
                else:
                    begin = (operations.time[e] + p * operations.period) * 1e-9 - steps.lengths[k]
                    copy_into(z, y)
                    advance_tangents(nonlinear, steps, work, tangents, own, z, dz, after, k, begin)
                    add_moments(looks.forms, work.moments, work.sums)
                    copy_into(y, z)
                    _hold(dz, after, size, z.size - size, groups)
            used, asked = (s - operations.sample[e]) & s_mask, (r - operations.reference[e]) & r_mask
            if what == SAMPLE:
                sample = dsamples[s & s_mask]
                _see(changes.sample, y, dz, groups, sample)
                _add(tangents.bias, sample, groups)
                s += 1
            elif what == REFERENCE:
                copy_numbers(dsamples[used], dz[held:], 2 * m)
                _hold(dz, after, held, 2 * m, groups)
                reference = dreferences[r & r_mask]
                _see(changes.reference, y, dz, groups, reference)
                r += 1
            elif what == MOTOR:
                _command(
                    looks.k_tot, tangents.k_tot, counting, motion, dsamples[used], dreferences[asked],
                    dz[size:], groups,
                )  # fmt: skip
                _hold(dz, after, size, 2 * m if counting else m, groups)
            elif what == OUTPUT:
                force = after[:m]
                _see(changes.force, y, dz, groups, force)
                _write(
                    looks.motion, motion, dz, force, dreferences[asked], out, row, beside, parameters, groups
                )
                if counting:
                    write_work(looks.forms, work.sums, y, out.work[row])
                row += 1
                if row == out.plant.shape[0]:
                    break
    copy_into(z, y)
    copy_numbers(dz, own.dz, z.size)
    count[0], count[1], count[2] = s, r, row
