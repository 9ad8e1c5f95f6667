"""The compiled kernel of linear loops: executes a program over step matrices."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, fused_in_place, inlined, unrolled
from rthm_core.engine.linear.periods import Periods, count_periods, feel, note
from rthm_core.engine.linear.vectors import Vector, moved, put, seen
from rthm_core.engine.worked import worked
from rthm_core.physical.sensors import Sensors, measured
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.simd import WIDTH, numbers, put_numbers


class Tables(NamedTuple):
    """Matrices of a program; each is transposed, with a row per element of [state, held inputs].

    Attributes
    ----------
    plant, numerical, aside : (K, ., n) arrays
        Steps of both sides, and of what work depends on beside them.
    felt : (., 2 m) array
        What of the motion that the numerical side holds matters for work.
    sample, plant_row, numerical_row : (K, ., outputs) arrays
        What is seen a time after the last change of an input.
    reference : (., m) array
        F_d from [state, held] of the numerical side.
    """

    plant: Floats
    numerical: Floats
    sample: Floats
    plant_row: Floats
    numerical_row: Floats
    reference: Floats
    bias: Floats
    k_tot: Floats
    aside: Floats
    felt: Floats


class Operations(NamedTuple):
    """Program for the kernel; arrays (2, operations): row 0 is the first pass, row 1 every further one.

    `plant`, `numerical` and `work` say which of the matrices an operation takes, -1: none; where work is
    counted, both sides take a step, or none does.
    """

    what: Integers
    time: Integers
    plant: Integers
    numerical: Integers
    sample: Integers
    reference: Integers
    period: int
    work: Integers


class Memory(NamedTuple):
    """Samples and references that are still needed, newest at ``count - 1`` modulo the (power of two) length.

    Attributes
    ----------
    samples, references : (length, 2 m), (length, m) arrays
        What has been there before the test is written in advance.
    count : (3,) array
        Samples, references and rows so far.
    """

    samples: Floats
    references: Floats
    count: Integers  # type: ignore[assignment]


ROW_COUNT = 2
"""Place of the number of rows in ``Memory.count``."""


class Counting(NamedTuple):
    """Work step by step: coefficients (K, pairs, 8) of the products of the joint state, and the sums so far
    (8,).
    """

    tables: Floats
    sums: Floats
    joint: Floats


@inlined
def _joined(joint: Floats, begin: int, part: Vector) -> int:
    """Write a part of the joint state from `begin` on; where the next begins."""
    for i in range(len(part)):
        joint[begin + i] = part[i]
    return begin + len(part)


@inlined
def _worked(
    tables: Floats,
    k: int,
    joint: Floats,
    plant: Vector,
    aside: Vector | None,
    commands: Vector,
    numerical: Vector,
    held: Vector,
    felt: Floats,
) -> Any:
    """Work (8,), a SIMD value, by table `k` from the joint state."""
    d = _joined(joint, 0, plant)
    if aside is not None:
        d = _joined(joint, d, aside)
    d = _joined(joint, _joined(joint, d, commands), numerical)
    for i in range(felt.shape[0]):
        joint[d + i] = feel(felt, i, held)
    return worked(tables, k, joint)


@unrolled
@fused_in_place
def run(
    tables: Tables,
    operations: Operations,
    memory: Memory,
    sensors: Sensors | None,
    counting: Counting | None,
    periods: Periods | None,
    plant: Any,
    command: Any,
    numerical: Any,
    held: Any,
    aside: Any,
    commands: Any,
    passes: int,
    out: Any,
    like: Any,
    scratch: Floats,
) -> tuple[Any, ...]:
    """Execute a program `passes` times or until the rows `out` are full.

    With `counting`, step by step, or `periods`, eight of them together, work is counted: both sides move at
    every change of an input then, with what is `aside`, whose inputs `commands` are the commands and their
    feedforward parts. `scratch` (1, .) has room for the longest of the states.
    Returns the states and held inputs; samples, references and their number stay in `memory`.
    """
    plant_step, numerical_step, sample_row, plant_row, numerical_row, reference_row, bias, k_tot = tables[:8]
    aside_step, felt = tables.aside, tables.felt
    what, time, plant_at, numerical_at, sample_back, reference_back, period, work_at = operations
    samples, references, count = memory
    plant_out, numerical_out, reference_out, work_out = out
    s_mask, r_mask = samples.shape[0] - 1, references.shape[0] - 1
    s, r, row = count[0], count[1], count[2]
    m, counted = len(like[2]), row
    rest, parts = aside, commands  # what is none stays so: the compiler leaves all out that it is in
    more = 0 if periods is None else 1  # what follows the last change is counted in the next pass
    for p in range(passes + more):
        later = what.size if p > 0 else 0
        change, lane = np.int64(0), (p - 1) % WIDTH
        for e in range(what.size if p < passes else 0):
            kind = what[e]
            if kind == OUTPUT:
                seen(plant_row, plant_at[later + e], plant, command, plant_out, row, like[0])
                seen(numerical_row, numerical_at[later + e], numerical, held, numerical_out, row, like[1])
                for i in range(m):
                    reference_out[row, i] = references[(r - reference_back[e]) & r_mask, i]
                if counting is not None:
                    k = work_at[later + e]
                    added = _worked(
                        counting.tables, k, counting.joint, plant, rest, parts, numerical, held, felt
                    )
                    put_numbers(work_out, (row,), numbers(counting.sums, ()) + added)
                row += 1
                if row == reference_out.shape[0]:
                    break
                continue
            if kind == SAMPLE:
                new = s & s_mask
                seen(sample_row, plant_at[later + e], plant, command, samples, new, held)
                for i in range(len(held)):
                    samples[new, i] += bias[i]
                    if sensors is not None:
                        stamp = time[e] + p * period
                        samples[new, i] = measured(sensors, i, samples[new, i], bias, stamp)
                s += 1
                continue
            used, asked = (s - sample_back[e]) & s_mask, (r - reference_back[e]) & r_mask
            step1, step2 = plant_at[later + e], numerical_at[later + e]
            if counting is not None and step1 >= 0:
                k = work_at[later + e]
                added = _worked(counting.tables, k, counting.joint, plant, rest, parts, numerical, held, felt)
                put_numbers(counting.sums, (), numbers(counting.sums, ()) + added)
            if periods is not None and step1 >= 0:
                note(periods.states, change, lane, plant, rest, parts, numerical, held, felt)
                change += 1
            if step1 >= 0:
                plant = moved(plant_step, step1, plant, command, scratch)
                if aside is not None:
                    rest = moved(aside_step, step1, rest, parts, scratch)
            if step2 >= 0:
                numerical = moved(numerical_step, step2, numerical, held, scratch)
            if kind == REFERENCE:
                for i in range(len(held)):
                    held = put(held, i, samples[used, i])
                seen(reference_row, 0, numerical, held, references, r & r_mask, like[2])
                r += 1
            elif kind == MOTOR:
                for i in range(m):
                    feedforward = references[asked, i] / k_tot[i]
                    given = samples[used, i] + feedforward
                    command = put(command, i, given)
                    if commands is not None:
                        parts = put(put(parts, i, given), m + i, feedforward)
        if periods is not None:
            note(periods.states, change, lane, plant, rest, parts, numerical, held, felt)
            if lane == WIDTH - 1 or p == passes:
                first, stop = lane if p == 0 else 0, lane if p == passes else lane + 1
                count_periods(periods, min(p, 1), first, stop, work_out, counted, row)
                counted += (lane + 1 - first) * periods.looks.rows
    count[0], count[1], count[2] = s, r, row
    return plant, command, numerical, held, rest, parts
