"""The compiled kernel of loops whose plant has laws that are not linear: executes a program."""

from __future__ import annotations

from typing import NamedTuple

from rthm_core.compiled import Floats, Integers, compiled_in_place, inlined, plainly
from rthm_core.engine.linear.kernel import Memory
from rthm_core.engine.nonlinear.advance import Work, advance
from rthm_core.engine.nonlinear.arc import begin_arc, count_within, end_arc, within_arc
from rthm_core.engine.nonlinear.forces import wire_forces
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.operations import Operations
from rthm_core.engine.nonlinear.packed import Packed, see
from rthm_core.engine.nonlinear.steps import Steps
from rthm_core.engine.worked import energy
from rthm_core.lent import lent
from rthm_core.physical.sensors import Sensors, measured
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import numbers, put_first


class Looks(NamedTuple):
    """What is seen of ``z = [y, held, g]``.

    Attributes
    ----------
    motion : (2 n1 + 2 n2,) array
        Places of x1, v1, x2, v2.
    bias : (2 m,) array
        Of the samples.
    sensors : Sensors
        Those of the samples; no rows where they add nothing.
    k_tot : (m,) array
        What the controller computes with, N/m.
    forms : (7, d (d + 1) / 2) array
        Work from the moments, and last the energy; empty where these are not counted.
    """

    motion: Integers
    bias: Floats
    sensors: Sensors
    k_tot: Floats
    forms: Floats


class Outputs(NamedTuple):
    """Rows [x1, v1, F], [x2, v2], F_d in use, and work with the energy."""

    plant: Floats
    numerical: Floats
    reference: Floats
    work: Floats


@inlined
def sample(looks, seen, begin, stamp, out):  # type: ignore[no-untyped-def]
    """Measured motion at the instant `stamp` (ns), which is seen from place `begin` on."""
    for i in range(out.size):
        out[i] = seen[begin + i] + looks.bias[i]
        if looks.sensors.key.size:
            out[i] = measured(looks.sensors, i, out[i], looks.bias, stamp)


@inlined
def command(looks, counting, size, measured_motion, reference, z):  # type: ignore[no-untyped-def]
    """Put a command into the held inputs of z: in two parts where work is counted."""
    m = looks.k_tot.size
    for i in range(m):
        force_part = reference[i] / looks.k_tot[i]
        if counting:
            z[size + i], z[size + m + i] = measured_motion[i], force_part
        else:
            z[size + i] = measured_motion[i] + force_part


@inlined
def write_row(seen, reference, out, row):  # type: ignore[no-untyped-def]
    """Write motion, forces in the wires, and the reference in use."""
    plant = out.plant.shape[1]
    for i in range(plant):
        out.plant[row, i] = seen[i]
    for i in range(out.numerical.shape[1]):
        out.numerical[row, i] = seen[plant + i]
    for i in range(reference.size):
        out.reference[row, i] = reference[i]


@inlined
def add_moments(forms, moments, sums):  # type: ignore[no-untyped-def]
    """Turn the moments into work."""
    for pair in range(moments.size):
        for term in range(forms.shape[0] - 1):
            sums[term] += forms[term, pair] * moments[pair]
        moments[pair] = 0.0


@inlined
def write_work(forms, sums, z, out):  # type: ignore[no-untyped-def]
    """Work so far, and the energy of the present state."""
    last = forms.shape[0] - 1
    for term in range(last):
        out[term] = sums[term]
    out[last] = energy(forms[last], z)


@inlined
def write_work_within(sums, out, row):  # type: ignore[no-untyped-def]
    """Write work and energy on the way through an arc."""
    put_first(out, (row, 0), numbers(sums, ()), out.shape[1])


@plainly
@compiled_in_place
def run_nonlinear(
    nonlinear: Nonlinear,
    steps: Steps,
    packed: Packed,
    work: Work,
    looks: Looks,
    operations: Operations,
    memory: Memory,
    z: Floats,
    passes: int,
    out: Outputs,
) -> None:
    """Execute a program `passes` times or until the rows `out` are full, from ``z = [y, held, g]`` on."""
    nonlinear, steps, packed, work = lent(nonlinear), lent(steps), lent(packed), lent(work)
    samples, references, count = memory
    s_mask, r_mask = samples.shape[0] - 1, references.shape[0] - 1
    s, r, row = count[0], count[1], count[2]
    m, first, seen = looks.k_tot.size, out.plant.shape[1] + out.numerical.shape[1], work.seen
    size, held = nonlinear.systems.shape[1], z.size - nonlinear.weight.size - 2 * m
    counting = looks.forms.shape[0] > 0
    number, arc, lengths, fresh = -1, -1, steps.lengths, False
    wire_forces(nonlinear, z, z)
    for p in range(passes):
        later, until = min(p, 1), -1
        for e in range(operations.what.size):
            what, k, span = operations.what[e], operations.length[later, e], operations.span[later, e]
            last, now = operations.last[later, e], operations.time[e] + p * operations.period
            if e > until and last >= e:
                arc = operations.span[later, last]
                begin = now * 1e-9 - (lengths[span] if span >= 0 else 0.0)
                number = begin_arc(nonlinear, steps, packed, work, z, arc, begin)
                until = last if number >= 0 else -1
            if k >= 0 and e > until:
                advance(nonlinear, steps, packed, work, z, k, now * 1e-9 - lengths[k])
                add_moments(looks.forms, work.moments, work.sums)
                fresh = False
            elif k >= 0 and span == arc:
                end_arc(nonlinear, steps, work, number, arc, z)
                fresh = False
            elif k >= 0:
                within_arc(nonlinear, steps, packed, work, number, arc, span)
                fresh = True
            used, asked = (s - operations.sample[e]) & s_mask, (r - operations.reference[e]) & r_mask
            if what == MOTOR:
                command(looks, counting, size, samples[used], references[asked], z)
                wire_forces(nonlinear, z, z)
                fresh = False
            elif what == REFERENCE:
                for i in range(2 * m):
                    z[held + i] = samples[used, i]
                fresh = False
            if not fresh and what in (SAMPLE, REFERENCE, OUTPUT):
                see(packed.columns, z, seen)
                fresh = True
            if what == SAMPLE:
                sample(looks, seen, first, now, samples[s & s_mask])
                s += 1
            elif what == REFERENCE:
                for i in range(m):
                    references[r & r_mask, i] = seen[first + 2 * m + i]
                r += 1
            elif what == OUTPUT:
                write_row(seen, references[asked], out, row)
                if counting and e <= until and 0 <= span != arc:
                    count_within(nonlinear, steps, work, number, span)
                    write_work_within(work.sums, out.work, row)
                elif counting:
                    write_work(looks.forms, work.sums, z, out.work[row])
                row += 1
                if row == out.plant.shape[0]:
                    break
    count[0], count[1], count[2] = s, r, row
