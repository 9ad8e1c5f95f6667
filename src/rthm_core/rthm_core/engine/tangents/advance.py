"""Advance a loop and its tangents where forces of laws are constant in each mode, compiled.

Where a law switches, the instant at which it does moves with the parameters, and the tangents jump:
``dy+ = dy- + (y'- - y'+) dt`` with ``dt = -dm / m'`` for a guard m that vanishes there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, inlined, whole
from rthm_core.engine.nonlinear.advance import MOST_SWITCHES, begin_step, end_step
from rthm_core.engine.nonlinear.steps import fill, terms_of, through
from rthm_core.engine.nonlinear.switch import first_left, product
from rthm_core.engine.tangents.steps import by_series, copy_numbers, fill_change
from rthm_core.lent import given, lent
from rthm_core.physical.laws import FRICTION, PARTITION, PLACE, POSITION
from rthm_core.physical.switching import next_mode
from rthm_core.simd import everywhere, numbers, put_numbers, simd_copy, simd_empty


class Term(NamedTuple):
    """A term (N,) of the series of y and its tangents (N, Q, 8)."""

    y: Floats
    dy: Floats


class TangentWork(NamedTuple):
    """What lasts from step to step, and scratch (`Scratch`).

    Attributes
    ----------
    halves : (2, d, Q, 8) array
        Tangents of [y, held, g] at the beginning of a step and those at its end.
    lanes : (2 d Q 8,) array
        The same memory.
    samples, references : (length 2 m Q 8,), (length m Q 8,) arrays
        Those of the memory.
    """

    halves: Floats
    lanes: Floats
    samples: Floats
    references: Floats
    rate: Floats
    shift: Floats
    one: Term
    other: Term
    unit: Floats
    zero: Floats
    change: Floats


class Scratch(NamedTuple):
    """Scratch of steps.

    Attributes
    ----------
    rate : (d,) array
        Of [y, held, g] just before a law switches.
    shift : (Q, 8) array
        How much later it switches, s per unit of each parameter.
    one, other : Term
    unit, zero, change : (d,), (d, Q, 8), (d, N, Q, 8) arrays
        `zero` is never written.
    """

    rate: Floats
    shift: Floats
    one: Term
    other: Term
    unit: Floats
    zero: Floats
    change: Floats


def scratch(shape: tuple[int, ...]) -> Scratch:
    """Scratch for changes of systems (S, N, d, Q, 8)."""
    _, n, d, *groups = shape
    zero = simd_copy(np.zeros((d, *groups)))
    return Scratch(
        np.zeros(d),
        simd_empty(*groups),
        Term(np.zeros(n), simd_empty(n, *groups)),
        Term(np.zeros(n), simd_empty(n, *groups)),
        np.zeros(d),
        zero,
        simd_empty(d, n, *groups),
    )


@inlined
def _forces(forces, modes, first, dz):  # type: ignore[no-untyped-def]
    """Tangents of the laws' forces in their present modes."""
    for row in range(modes.size):
        for group in range(dz.shape[1]):
            put_numbers(dz, (first + row, group), numbers(forces, (row, modes[row] + 1, group)))


@inlined
def begin_tangents(nonlinear, work, tangents, z, dz):  # type: ignore[no-untyped-def]
    """Put the forces of the laws, which do not depend on time, into z and their tangents into dz."""
    begin_step(nonlinear, z, 0.0, work.modes)
    _forces(tangents.forces, work.modes, z.size - nonlinear.input_matrix.shape[1], dz)


@inlined
def _guard(nonlinear, tangents, number, law, mode, slope, sign, z, dz, group):  # type: ignore[no-untyped-def]
    """Tangents of what vanishes where a law leaves its mode, with this `slope` over time; `sign`: of the
    force that holds its dof.
    """
    partition, place = nonlinear.laws.numbers[law, PARTITION], nonlinear.laws.numbers[law, PLACE]
    if partition == POSITION:
        passed = min(mode, 1) if slope > 0.0 else max(mode - 1, 0)
        return numbers(dz, (place, group)) - numbers(tangents.thresholds, (law, passed, group))
    if mode != 0:
        return numbers(dz, (place + nonlinear.n, group))
    holds = nonlinear.holds[number, law]
    guard = numbers(tangents.breakaway, (law, group)) * -sign
    for j in range(z.size):
        guard += holds[j] * numbers(dz, (j, group)) + numbers(tangents.holds, (number, law, j, group)) * z[j]
    return guard


@inlined
def _slope(nonlinear, number, law, mode, rate):  # type: ignore[no-untyped-def]
    """Rate of the same, from those of [y, held, g]."""
    partition, place = nonlinear.laws.numbers[law, PARTITION], nonlinear.laws.numbers[law, PLACE]
    if partition == POSITION:
        return rate[place]
    return rate[place + nonlinear.n] if mode != 0 else product(nonlinear.holds[number, law], rate)


@inlined
def shift_of(nonlinear, tangents, number, law, mode, z, dz, rate, shift):  # type: ignore[no-untyped-def]
    """How much later a law leaves its mode, for each parameter."""
    slope = _slope(nonlinear, number, law, mode, rate)
    sign = 1.0 if product(nonlinear.holds[number, law], z) > 0.0 else -1.0
    for group in range(dz.shape[1]):
        guard = _guard(nonlinear, tangents, number, law, mode, slope, sign, z, dz, group)
        put_numbers(shift, (group,), guard / -slope if slope != 0.0 else everywhere(0.0))


@inlined
def rates(nonlinear, number, z, rate):  # type: ignore[no-untyped-def]
    """Rate of y, into the leading elements of `rate`."""
    for i in range(nonlinear.systems.shape[1]):
        rate[i] = product(nonlinear.systems[number, i], z)


@inlined
def jump(nonlinear, following, law, mode, z, dz, rate, shift):  # type: ignore[no-untyped-def]
    """Let the tangents jump where a law goes over into a mode, and the set that sticks is the `following`."""
    for i in range(nonlinear.systems.shape[1]):
        change = rate[i] - product(nonlinear.systems[following, i], z)
        for group in range(shift.shape[0]):
            put_numbers(dz, (i, group), numbers(dz, (i, group)) + change * numbers(shift, (group,)))
    if mode == 0 and nonlinear.laws.numbers[law, PARTITION] == FRICTION:  # at rest, whatever the parameter
        for group in range(shift.shape[0]):
            put_numbers(dz, (nonlinear.laws.numbers[law, PLACE] + nonlinear.n, group), everywhere(0.0))


@inlined
def _cross(nonlinear, work, tangents, own, number, law, z, dz, t):  # type: ignore[no-untyped-def]
    """Let a law switch at `t`, where it leaves its mode, and the tangents jump."""
    first = z.size - nonlinear.input_matrix.shape[1]
    rates(nonlinear, number, z, own.rate)
    mode = work.modes[law]
    shift_of(nonlinear, tangents, number, law, mode, z, dz, own.rate, own.shift)
    hold = product(nonlinear.holds[number, law], z)
    work.modes[law] = next_mode(nonlinear.laws, nonlinear.n, law, mode, z, hold)
    following = begin_step(nonlinear, z, t, work.modes)
    _forces(tangents.forces, work.modes, first, dz)
    jump(nonlinear, following, law, work.modes[law], z, dz, own.rate, own.shift)


@whole
def advance_tangents(nonlinear, steps, work, tangents, own, z, dz, after, k, t):  # type: ignore[no-untyped-def]
    """Advance z and its tangents dz over length `k`, from time `t` (s) on; `after` is scratch."""
    nonlinear, steps, work = lent(given(nonlinear)), lent(given(steps)), lent(given(work))
    tangents, own = lent(given(tangents)), lent(given(own))
    size, whole, lengths = nonlinear.systems.shape[1], steps.lengths[k], steps.lengths.size
    first, done, length, switches = z.size - nonlinear.input_matrix.shape[1], 0.0, whole, 0
    while done < whole:
        number = begin_step(nonlinear, z, t + done, work.modes)
        _forces(tangents.forces, work.modes, first, dz)
        slot = number * lengths + k if length == whole else steps.filled.size - 1
        if length != whole or not steps.filled[slot]:
            fill(nonlinear.systems[number], nonlinear.fastest, steps, slot, length)
            steps.filled[slot] = 1
        for j in range(size, z.size):
            work.end[j] = z[j]
        through(steps.matrices[slot, 0], z, work.end)
        law, share, terms = -1, 1.0, 0
        if switches < MOST_SWITCHES:
            law, share, terms = first_left(nonlinear, work, number, z, length)
        by_series(
            nonlinear.systems[number], tangents.systems[number], share * length,
            terms_of(nonlinear.fastest * length), z, dz, own.one, own.other, after[:size],
        )  # fmt: skip
        copy_numbers(after, dz, size)
        end_step(nonlinear, work, number, z, law, share, terms, length)
        for i in range(size):
            z[i] = work.end[i]
        done = whole if law < 0 else done + share * length
        if law >= 0:
            _cross(nonlinear, work, tangents, own, number, law, z, dz, t + done)
            switches += 1
        length = whole - done
    begin_step(nonlinear, z, t + whole, work.modes)
    _forces(tangents.forces, work.modes, first, dz)


@inlined
def change_of_step(nonlinear, steps, tangents, own, number, k):  # type: ignore[no-untyped-def]
    """Change of the matrix of a step over length `k`, into ``own.change``."""
    length = steps.lengths[k]
    fill_change(
        nonlinear.systems[number], tangents.systems[number], length, terms_of(nonlinear.fastest * length),
        own.unit, own.zero, own.one, own.other, own.change,
    )  # fmt: skip
