"""The compiled kernel of loops whose plant has laws that are not linear: executes a program."""

from __future__ import annotations

from typing import NamedTuple

from rthm_core.compiled import Floats, Integers, compiled_in_place, inlined, plainly
from rthm_core.engine.linear.kernel import Memory
from rthm_core.engine.nonlinear.advance import Work, advance
from rthm_core.engine.nonlinear.event_free import event_free_step
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.steps import Steps
from rthm_core.engine.worked import energy
from rthm_core.physical.sensors import Sensors, measured
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE


class Looks(NamedTuple):
    """What is seen of ``z = [y, held, g]``.

    Attributes
    ----------
    sample, force, reference : (., N + M) arrays
        Measured motion, forces in the wires, F_d.
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

    sample: Floats
    force: Floats
    reference: Floats
    motion: Integers
    bias: Floats
    sensors: Sensors
    k_tot: Floats
    forms: Floats


class Operations(NamedTuple):
    """Program: arrays (operations,), and (2, operations) for the first and for every further pass.

    `length` is the number of the length since the operation before, -1: none.
    """

    what: Integers
    time: Integers
    length: Integers
    sample: Integers
    reference: Integers
    period: int


class Outputs(NamedTuple):
    """Rows [x1, v1, F], [x2, v2], F_d in use, and work with the energy."""

    plant: Floats
    numerical: Floats
    reference: Floats
    work: Floats


@inlined
def look(matrix, z, out):  # type: ignore[no-untyped-def]
    """What is seen of z through the rows of a matrix."""
    for i in range(matrix.shape[0]):
        total = 0.0
        for j in range(matrix.shape[1]):
            total += matrix[i, j] * z[j]
        out[i] = total


@inlined
def sample(looks, z, stamp, out):  # type: ignore[no-untyped-def]
    """Measured motion at the instant `stamp` (ns)."""
    look(looks.sample, z, out)
    for i in range(out.size):
        out[i] += looks.bias[i]
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
def write_row(looks, z, reference, out, row):  # type: ignore[no-untyped-def]
    """Write motion, forces in the wires, and the reference in use."""
    motion, x1v1 = looks.motion, out.plant.shape[1] - looks.k_tot.size
    for i in range(x1v1):
        out.plant[row, i] = z[motion[i]]
    look(looks.force, z, out.plant[row, x1v1:])
    for i in range(out.numerical.shape[1]):
        out.numerical[row, i] = z[motion[x1v1 + i]]
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


@plainly
@compiled_in_place
def run_nonlinear(
    nonlinear: Nonlinear,
    steps: Steps,
    work: Work,
    looks: Looks,
    operations: Operations,
    memory: Memory,
    z: Floats,
    passes: int,
    out: Outputs,
) -> None:
    """Execute a program `passes` times or until the rows `out` are full, from ``z = [y, held, g]`` on."""
    samples, references, count = memory
    s_mask, r_mask = samples.shape[0] - 1, references.shape[0] - 1
    s, r, row = count[0], count[1], count[2]
    size, m = nonlinear.systems.shape[1], looks.k_tot.size
    held, counting = looks.sample.shape[1] - 2 * m, looks.forms.shape[0] > 0
    matrices, filled, lengths, tables = steps.matrices, steps.filled, steps.lengths, steps.work_tables
    sums = work.sums
    quick = nonlinear.steady and (tables.shape[0] > 0 or not counting)
    systems, holds, bits, places = nonlinear.systems, nonlinear.holds, nonlinear.bits, nonlinear.laws.numbers
    breakaway, modes, end = nonlinear.laws.breakaway, work.modes, work.end[:size]
    for p in range(passes):
        later = min(p, 1)
        for e in range(operations.what.size):
            what, k = operations.what[e], operations.length[later, e]
            now = operations.time[e] + p * operations.period
            event_free = quick and k >= 0
            if event_free:
                event_free = event_free_step(
                    systems, holds, bits, places, nonlinear.n, breakaway, matrices, filled, lengths, tables,
                    k, z, modes, end, sums,
                )  # fmt: skip
            if event_free:
                for i in range(size):
                    z[i] = end[i]
            elif k >= 0:
                advance(nonlinear, steps, work, z, k, now * 1e-9 - lengths[k])
                add_moments(looks.forms, work.moments, sums)
            used, asked = (s - operations.sample[e]) & s_mask, (r - operations.reference[e]) & r_mask
            if what == SAMPLE:
                sample(looks, z, now, samples[s & s_mask])
                s += 1
            elif what == REFERENCE:
                for i in range(2 * m):
                    z[held + i] = samples[used, i]
                look(looks.reference, z, references[r & r_mask])
                r += 1
            elif what == MOTOR:
                command(looks, counting, size, samples[used], references[asked], z)
            elif what == OUTPUT:
                write_row(looks, z, references[asked], out, row)
                if counting:
                    write_work(looks.forms, sums, z, out.work[row])
                row += 1
                if row == out.plant.shape[0]:
                    break
    count[0], count[1], count[2] = s, r, row
