"""What a loop does in one period of its clocks, noted once and then done again, compiled.

Where periods of clocks have a common multiple, the same things happen in each, with samples and references
that are so many numbers further on. What comes next, and which matrix that takes, need not be asked again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, inlined
from rthm_core.engine.linear.vectors import moved, put, seen

COMMAND, SAMPLE, TICK = range(3)
"""A command reaches the motors, the plant is sampled, the numerical side ticks."""

EVENTS_NOTED = 1024
"""Events of a period up to which they are noted."""

LONGEST_PERIOD_NS = 10**12
"""Longest period, in ns, that is worth a note."""


class Between(NamedTuple):
    """What passes between the sides; (m,) arrays: dofs, k_tot, interface stiffness and damping."""

    dof1: Integers
    dof2: Integers
    k_tot: Floats
    stiffness: Floats
    damping: Floats


class Passing(NamedTuple):
    """Memories (., 2 m) and (., m) of samples and references, which have a power of two of rows, and a last
    one for what has been there before the test.
    """

    samples: Floats
    references: Floats


class Notes(NamedTuple):
    """What happens in a period, (EVENTS_NOTED, 4): event, number of its matrix, and of what it uses or
    makes; and how much of that there is, (1,).
    """

    events: Integers
    size: Integers


def notes() -> Notes:
    """Nothing noted yet."""
    return Notes(np.empty((EVENTS_NOTED, 4), dtype=np.int64), np.zeros(1, dtype=np.int64))


@inlined
def note(notes, event, k, first, second):  # type: ignore[no-untyped-def]
    """Note an event, or only count it where there are too many."""
    e = notes.size[0]
    if e < EVENTS_NOTED:
        notes.events[e, 0], notes.events[e, 1] = event, k
        notes.events[e, 2], notes.events[e, 3] = first, second
    notes.size[0] = e + 1


@inlined
def _common(one, other):  # type: ignore[no-untyped-def]
    """Least common multiple, or 0 where it is too long or one of both is 0."""
    a, b = one, other
    while b > 0:
        a, b = b, a % b
    return 0 if one == 0 or one // a > LONGEST_PERIOD_NS // other else one // a * other


@inlined
def common_period(clocks):  # type: ignore[no-untyped-def]
    """Time in ns after which everything happens again; 0: it does not, or not soon."""
    return _common(_common(clocks.td1, clocks.td2), clocks.td3)


@inlined
def row_of(number, rows):  # type: ignore[no-untyped-def]
    """Row of a memory in which a sample or a reference is; the last one for what was before the test."""
    return number & (rows - 2) if number >= 0 else rows - 1


@inlined
def commanded(between, passing, latched, arrived, command):  # type: ignore[no-untyped-def]
    """Command from a sample and a reference."""
    used, asked = row_of(latched, passing.samples.shape[0]), row_of(arrived, passing.references.shape[0])
    for i in range(between.k_tot.size):
        part = passing.references[asked, i] / between.k_tot[i]
        command = put(command, i, passing.samples[used, i] + part)
    return command


@inlined
def keep_sample(between, passing, sampled, look):  # type: ignore[no-untyped-def]
    """Keep what is seen of the plant as a sample."""
    place, m, n = row_of(sampled, passing.samples.shape[0]), between.k_tot.size, look.shape[1] // 2
    for i in range(m):
        passing.samples[place, i] = look[0, between.dof1[i]]
        passing.samples[place, m + i] = look[0, n + between.dof1[i]]


@inlined
def latch(passing, taken, held):  # type: ignore[no-untyped-def]
    """Motion that the numerical side holds."""
    used = row_of(taken, passing.samples.shape[0])
    for i in range(passing.samples.shape[1]):
        held = put(held, i, passing.samples[used, i])
    return held


@inlined
def keep_reference(between, passing, number, numerical, held):  # type: ignore[no-untyped-def]
    """Keep F_d between the held and the present motion as a reference."""
    row, m, n = row_of(number, passing.references.shape[0]), between.k_tot.size, len(numerical) // 2
    for i in range(m):
        v2, x2 = numerical[n + between.dof2[i]], numerical[between.dof2[i]]
        damper = between.damping[i] * (held[m + i] - v2)
        passing.references[row, i] = -damper - between.stiffness[i] * (held[i] - x2)


@inlined
def repeat(  # type: ignore[no-untyped-def]
    notes, ahead, further, begin, end, one, two, between, passing, plant, command, numerical, held
):
    """Do again what is noted, for the periods `begin` to `end` after the noted one; states and inputs at the
    end. Samples are `ahead`, and references `further`, from period to period.
    """
    matrices1, matrices2 = one.steps.matrices[:, 0], two.steps.matrices[:, 0]
    for p in range(begin, end):
        for e in range(notes.size[0]):
            event, k = notes.events[e, 0], notes.events[e, 1]
            first, second = notes.events[e, 2] + p * ahead, notes.events[e, 3] + p * further
            if event == COMMAND:
                plant = moved(matrices1, k, plant, command, one.look)
                command = commanded(between, passing, first, second, command)
            elif event == SAMPLE:
                seen(matrices1, k, plant, command, one.look, 0, plant)
                keep_sample(between, passing, first, one.look)
            else:
                numerical = moved(matrices2, k, numerical, held, two.look)
                held = latch(passing, first, held)
                keep_reference(between, passing, second, numerical, held)
    return plant, command, numerical, held
