"""The compiled kernel of a loop and its tangents: what `curved.kernel` runs, with derivatives beside it.

Clocks do not depend on physics, so that both follow one program.
"""

from __future__ import annotations

from typing import NamedTuple

from rthm_core.compiled import Floats, Integers, compiled_in_place, copy_into, inlined
from rthm_core.engine.curved.advance import Work, set_of
from rthm_core.engine.curved.kernel import (
    Looks,
    Operations,
    Outputs,
    add_moments,
    command,
    look,
    sample,
    write_row,
    write_works,
)
from rthm_core.engine.curved.loop import Curved
from rthm_core.engine.curved.quiet import quiet_step
from rthm_core.engine.curved.steps import Steps
from rthm_core.engine.linear.kernel import Memory
from rthm_core.engine.tangents.advance import TangentWork, advance_tangents, change_of_step
from rthm_core.engine.tangents.changes import Columns, Tangents
from rthm_core.engine.tangents.steps import by_matrix, copy_numbers
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.wide import WIDTH, numbers, put_numbers, put_numbers_from


class Seen(NamedTuple):
    """Transposed matrices (N + M, .) of what is seen of [y, held]."""

    sample: Floats
    force: Floats
    reference: Floats


class TangentSteps(NamedTuple):
    """Changes (K, d, N, Q, 8) of the steps' matrices, which of them are there, and what is seen."""

    changes: Floats
    filled: Integers
    seen: Seen
    columns: Columns


@inlined
def _add(bias, out):  # type: ignore[no-untyped-def]
    for i in range(out.shape[0]):
        for group in range(out.shape[1]):
            put_numbers(out, (i, group), numbers(out, (i, group)) + numbers(bias, (i, group)))


@inlined
def _command_change(  # type: ignore[no-untyped-def]
    k_tot, change, counting, size, reference, dsample, dreference, dz
):
    """Tangents of a command: of its two parts where works are counted."""
    m = k_tot.size
    for i in range(m):
        compliance, part = 1.0 / k_tot[i], reference[i] / k_tot[i]
        for group in range(dz.shape[1]):
            beside = (numbers(dreference, (i, group)) - part * numbers(change, (i, group))) * compliance
            if counting:
                put_numbers(dz, (size + i, group), numbers(dsample, (i, group)))
                put_numbers(dz, (size + m + i, group), beside)
            else:
                put_numbers(dz, (size + i, group), numbers(dsample, (i, group)) + beside)


@inlined
def _put(dz, i, beside, place, parameters):  # type: ignore[no-untyped-def]
    """Write the tangents of one signal; those beyond the parameters are overwritten by the next."""
    for group in range(dz.shape[1]):
        put_numbers_from(beside, place * parameters + group * WIDTH, numbers(dz, (i, group)))


@inlined
def _write(motion, plant, dz, dforce, dreference, beside, row, parameters):  # type: ignore[no-untyped-def]
    """Tangents of a row [x1, v1, F, x2, v2, F_d]; `plant` is how many of them belong to the plant."""
    m = dforce.shape[0]
    place = row * (motion.size + 2 * m)
    for i in range(plant - m):
        _put(dz, motion[i], beside, place + i, parameters)
    for i in range(m):
        _put(dforce, i, beside, place + plant - m + i, parameters)
    for i in range(plant - m, motion.size):
        _put(dz, motion[i], beside, place + m + i, parameters)
    for i in range(m):
        _put(dreference, i, beside, place + motion.size + m + i, parameters)


@compiled_in_place
def run_tangents(
    curved: Curved,
    steps: Steps,
    work: Work,
    looks: Looks,
    operations: Operations,
    memory: Memory,
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

    The tangents of each row [x1, v1, F, x2, v2, F_d] with respect to so many `parameters`, of which there are
    as many `groups` as the tuple is long, follow each other in `beside`, which has `WIDTH` numbers to spare.
    """
    samples, references, count = memory
    s_mask, r_mask = samples.shape[0] - 1, references.shape[0] - 1
    s, r, row = count[0], count[1], count[2]
    size, held = curved.systems.shape[1], looks.sample.shape[1] - looks.sample.shape[0]
    systems, holds, bits, places = curved.systems, curved.holds, curved.bits, curved.laws.numbers
    breakaway, pieces, end, sums = curved.laws.breakaway, work.pieces, work.end[:size], work.sums
    matrices, filled, lengths, works = steps.matrices, steps.filled, steps.lengths, steps.works
    m, seen, columns, counting = looks.k_tot.size, changes.seen, changes.columns, looks.forms.shape[0] > 0
    quick = works.shape[0] > 0 or not counting
    dz, dsamples, dreferences, after = own.dz, own.samples, own.references, own.after
    for p in range(passes):
        later = min(p, 1)
        for e in range(operations.what.size):
            what, k = operations.what[e], operations.length[later, e]
            now = operations.time[e] + p * operations.period
            quiet, number = False, 0
            if k >= 0:
                number = set_of(bits, pieces)
                quiet = quick and quiet_step(
                    systems, holds, bits, places, curved.n, breakaway, matrices, filled, lengths, works,
                    k, z, pieces, end, sums,
                )  # fmt: skip
            if quiet:
                slot = number * lengths.size + k
                if not changes.filled[slot]:
                    change_of_step(curved, steps, tangents, own, number, k, changes.changes[slot])
                    changes.filled[slot] = 1
                by_matrix(matrices[slot, 0], changes.changes[slot], columns.steps, z, dz, groups, after)
                copy_numbers(after, dz, size)
                for i in range(size):
                    z[i] = end[i]
            elif k >= 0:
                advance_tangents(curved, steps, work, tangents, own, z, k, now * 1e-9 - lengths[k])
                add_moments(looks.forms, work.moments, sums)
            used, asked = (s - operations.sample[e]) & s_mask, (r - operations.reference[e]) & r_mask
            if what == SAMPLE:
                sample(looks, z, now, samples[s & s_mask])
                by_matrix(seen.sample, tangents.sample, columns.sample, z, dz, groups, dsamples[s & s_mask])
                _add(tangents.bias, dsamples[s & s_mask])
                s += 1
            elif what == REFERENCE:
                copy_into(z[held : held + samples.shape[1]], samples[used])
                copy_numbers(dsamples[used], dz[held:], samples.shape[1])
                look(looks.reference, z, references[r & r_mask])
                by_matrix(
                    seen.reference, tangents.reference, columns.reference, z, dz, groups,
                    dreferences[r & r_mask],
                )  # fmt: skip
                r += 1
            elif what == MOTOR:
                command(looks, counting, size, samples[used], references[asked], z)
                _command_change(
                    looks.k_tot,
                    tangents.k_tot,
                    counting,
                    size,
                    references[asked],
                    dsamples[used],
                    dreferences[asked],
                    dz,
                )
            elif what == OUTPUT:
                write_row(looks, z, references[asked], out, row)
                if counting:
                    write_works(looks.forms, sums, z, out.works[row])
                by_matrix(seen.force, tangents.force, columns.force, z, dz, groups, after[:m])
                _write(
                    looks.motion, out.plant.shape[1], dz, after[:m], dreferences[asked], beside, row,
                    parameters,
                )  # fmt: skip
                row += 1
                if row == out.plant.shape[0]:
                    break
    count[0], count[1], count[2] = s, r, row
