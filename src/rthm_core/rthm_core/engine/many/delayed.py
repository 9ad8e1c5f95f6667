"""The kernel of one plain loop with clocks and delays of its own, compiled: no program is made beforehand.

Where delays are constant, the instant of everything that happens follows from its number. The loop takes
whichever of six streams comes next: commands on the controller's ticks and commands for new references, the
samples that either use, ticks of the numerical side, and rows. Once it has gone through a whole period of its
clocks, all periods without a row are repetitions.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, compiled_in_place, inlined
from rthm_core.engine.linear.vectors import moved, put, seen
from rthm_core.engine.many.period import (
    COMMAND,
    EVENTS_NOTED,
    SAMPLE,
    TICK,
    Between,
    Notes,
    Passing,
    commanded,
    common_period,
    keep_reference,
    keep_sample,
    latch,
    note,
    repeat,
    row_of,
)
from rthm_core.engine.nonlinear.steps import Steps, fill
from rthm_core.link import NEVER
from rthm_core.schedule import INITIAL

LENGTHS_KEPT = 64
"""Lengths of which the matrices are kept; further ones are made each time."""


class Clocks(NamedTuple):
    """Periods and delays, in ns; td4 is zero and tau4 is not."""

    td1: int
    td2: int
    td3: int
    tau1: int
    tau2: int
    tau3: int
    tau4: int


class Loops(NamedTuple):
    """What is different in each of L loops.

    Attributes
    ----------
    a1, a2 : (L, ., .) arrays
        Dynamics of [state, held inputs] of both sides.
    y1, y2 : (L, .) arrays
        These at the start.
    k_tot, stiffness, damping : (L, m) arrays
        Of actuators and interface.
    fastest : (L, 2) array
        Fastest mode of each side, 1/s.
    clocks : (L, 7) array
        As in `Clocks`.
    """

    a1: Floats
    a2: Floats
    y1: Floats
    y2: Floats
    k_tot: Floats
    stiffness: Floats
    damping: Floats
    fastest: Floats
    clocks: Integers


class Moving(NamedTuple):
    """One side: rate (N, N + inputs) of its state, its fastest mode (1,) in 1/s, memory of its steps, the
    length of each in ns, and scratch (1, N).
    """

    system: Floats
    fastest: Floats
    steps: Steps
    lengths: Integers
    look: Floats


@inlined
def _length(lengths, filled, last, length):  # type: ignore[no-untyped-def]
    """Place of a length, searched for from the one after the last on, since they come in turns; the first
    free place, or the last of all, where it is not there.
    """
    known = filled[lengths.size - 1]
    for i in range(known):
        k = last + 1 + i
        k -= known if k >= known else 0
        if lengths[k] == length:
            return k
    return min(known, lengths.size - 1)


@inlined
def _matrix(side, last, length):  # type: ignore[no-untyped-def]
    """Number of the matrix of a step of `length` ns."""
    filled = side.steps.filled
    k = _length(side.lengths, filled, last, length)
    if side.lengths[k] != length:
        fill(side.system, side.fastest[0], side.steps, k, length * 1e-9)
        side.lengths[k] = length
        filled[side.lengths.size - 1] = min(k + 1, side.lengths.size - 1)
    return k


@inlined
def _newest(number, period, delay, now):  # type: ignore[no-untyped-def]
    """Newest sample of a clock that has arrived, searched for from an earlier one on."""
    while (number + 1) * period + delay <= now:
        number += 1
    return number


@inlined
def _next_use(index, sample, period, delay, td1):  # type: ignore[no-untyped-def]
    """Next tick of a clock that uses a newer sample, and this sample."""
    last = sample
    while sample == last:
        index += 1
        sample = _newest(sample, td1, delay, index * period)
    return index, sample


@inlined
def _known(side):  # type: ignore[no-untyped-def]
    """Whether the matrices of all lengths so far are kept."""
    return side.steps.filled[side.lengths.size - 1] < side.lengths.size - 1


@inlined
def _run(clocks, between, one, two, passing, notes, plant, command, numerical, held, step, out):  # type: ignore[no-untyped-def]
    """Simulate a loop and fill its rows `out` (N, n1 + n2 + 2 m)."""
    td1, td2, td3, tau1, tau2, tau3, tau4 = clocks
    k_tot, dof1 = between.k_tot, between.dof1
    matrices1, matrices2 = one.steps.matrices[:, 0], two.steps.matrices[:, 0]
    n1, n2, m = len(plant), len(numerical), k_tot.size
    look1, look2 = one.look, two.look
    since1, since2, k1, k2 = 0, 0, 0, 0
    tick, change, number, row = 0, 0, 0, 0
    latched, arrived, taken = INITIAL, INITIAL, INITIAL
    use1, sample1 = _next_use(INITIAL, INITIAL, td3, tau1, td1)
    use2, sample2 = _next_use(INITIAL, INITIAL, td2, tau2, td1)
    period, noting, noted = common_period(clocks), False, NEVER
    steady = tau1 + tau2 + tau3 + tau4 + 2 * (td1 + td2 + td3)
    boundary = NEVER if period == 0 else (steady // period + 1) * period
    while row < out.shape[0]:
        given = min(tick * td3, change * td2 + tau3)
        sampled = min(sample1, sample2)
        now = min(min(given + tau4, sampled * td1), min(number * td2, row * step))
        if now >= boundary:
            passes = 0
            if noted == NEVER:
                noting, noted, notes.size[0] = True, boundary, 0
            elif noting and not (_known(one) and _known(two) and notes.size[0] <= EVENTS_NOTED):
                noting, boundary = False, NEVER
                continue
            else:
                noting, passes = False, max((row * step - boundary) // period, 0)
            if passes > 0:
                first, ahead, further = (boundary - noted) // period, period // td1, period // td2
                plant, command, numerical, held = repeat(
                    notes, ahead, further, first, first + passes, one, two, between, passing,
                    plant, command, numerical, held,
                )  # fmt: skip
                gone, ahead, further = passes * period, passes * ahead, passes * further
                since1, since2, boundary = since1 + gone, since2 + gone, boundary + gone
                tick, use1, use2 = tick + gone // td3, use1 + gone // td3, use2 + further
                change, number, arrived = change + further, number + further, arrived + further
                latched, taken = latched + ahead, taken + ahead
                sample1, sample2 = sample1 + ahead, sample2 + ahead
                continue
            boundary += period
        if now == given + tau4:
            k1 = _matrix(one, k1, now - since1)
            plant, since1 = moved(matrices1, k1, plant, command, look1), now
            if given == tick * td3:
                latched, tick = _newest(latched, td1, tau1, given), tick + 1
            arrived = _newest(arrived, td2, tau3, given)
            change = arrived + 1
            command = commanded(between, passing, latched, arrived, command)
            if noting:
                note(notes, COMMAND, k1, latched, arrived)
        elif now == sampled * td1:
            k1 = _matrix(one, k1, now - since1)
            seen(matrices1, k1, plant, command, look1, 0, plant)
            keep_sample(between, passing, sampled, look1)
            if noting:
                note(notes, SAMPLE, k1, sampled, 0)
            if sample1 == sampled:
                use1, sample1 = _next_use(use1, sample1, td3, tau1, td1)
            if sample2 == sampled:
                use2, sample2 = _next_use(use2, sample2, td2, tau2, td1)
        elif now == number * td2:
            k2 = _matrix(two, k2, now - since2)
            numerical, since2 = moved(matrices2, k2, numerical, held, look2), now
            taken = _newest(taken, td1, tau2, now)
            held = latch(passing, taken, held)
            keep_reference(between, passing, number, numerical, held)
            if noting:
                note(notes, TICK, k2, taken, number)
            number += 1
        else:
            k1, k2 = _matrix(one, k1, now - since1), _matrix(two, k2, now - since2)
            seen(matrices1, k1, plant, command, look1, 0, plant)
            seen(matrices2, k2, numerical, held, look2, 0, numerical)
            asked = row_of((now - tau3) // td2, passing.references.shape[0])
            for i in range(n1):
                out[row, i] = look1[0, i]
            for i in range(n2):
                out[row, n1 + i] = look2[0, i]
            for i in range(m):
                out[row, n1 + n2 + i] = passing.references[asked, i]
                out[row, n1 + n2 + m + i] = k_tot[i] * (command[i] - look1[0, dof1[i]])
            row += 1


def moving(states: int, inputs: int) -> Moving:
    """A side without a loop yet."""
    rows = states + inputs
    steps = Steps(
        np.empty((LENGTHS_KEPT, 1, rows, states)),
        np.zeros(LENGTHS_KEPT, dtype=np.int64),
        np.empty(0),
        np.empty((0, 0, 0)),
        np.empty((2, rows, states)),
        np.empty((rows + 1, states)),
    )
    return Moving(
        np.empty((states, rows)),
        np.zeros(1),
        steps,
        np.empty(LENGTHS_KEPT, dtype=np.int64),
        np.empty((1, states)),
    )


def memories(clocks: Integers, m: int) -> Passing:
    """Memories of samples and references that are long enough for all `clocks` (L, 7)."""
    td1, td2, td3, tau1, tau2, tau3, tau4 = clocks.T
    samples = np.max(np.maximum(tau1 + td3 + tau4, tau2) // td1)
    references = np.max((tau3 + tau4 + td3) // td2)
    lengths = [(1 << (int(needed) + 2).bit_length()) + 1 for needed in (samples, references)]
    return Passing(np.empty((lengths[0], 2 * m)), np.empty((lengths[1], m)))


@inlined
def _begin(side, dynamics, fastest):  # type: ignore[no-untyped-def]
    """Give a side the dynamics of another loop, whose steps are not known yet."""
    for i in range(side.system.shape[0]):
        for j in range(side.system.shape[1]):
            side.system[i, j] = dynamics[i, j]
    side.fastest[0] = fastest
    for k in range(side.lengths.size):
        side.lengths[k] = -1
    side.steps.filled[side.lengths.size - 1] = 0


@inlined
def _filled(like, values, first):  # type: ignore[no-untyped-def]
    """Vector like another with some values."""
    for i in range(len(like)):
        like = put(like, i, values[first + i])
    return like


@compiled_in_place
def run_each(
    loops: Loops,
    dofs: tuple[Integers, Integers],
    sides: tuple[Moving, Moving],
    passing: Passing,
    notes: Notes,
    like: Any,
    step: int,
    out: Floats,
) -> None:
    """Simulate one loop after the other and fill their rows `out` (L, N, n1 + n2 + 2 m), one every `step` ns:
    motion of both sides, F_d in use, wire force.

    Parameters
    ----------
    loops : Loops
        What is different in each.
    dofs : (m,) arrays
        Interface dofs of both sides.
    sides, passing, notes
        Of the right size (`moving`, `memories`, `notes`).
    like : tuple
        Vectors as long as the states and held inputs: plant, commands, numerical side, latched motion.
    """
    (one, two), (samples, references), m = sides, passing, loops.k_tot.shape[1]
    n1, n2 = len(like[0]), len(like[2])
    for i in range(loops.clocks.shape[0]):
        t, k_tot, y1, y2 = loops.clocks[i], loops.k_tot[i], loops.y1[i], loops.y2[i]
        between = Between(dofs[0], dofs[1], k_tot, loops.stiffness[i], loops.damping[i])
        _begin(one, loops.a1[i], loops.fastest[i, 0])
        _begin(two, loops.a2[i], loops.fastest[i, 1])
        for j in range(2 * m):
            samples[samples.shape[0] - 1, j] = y2[n2 + j]
        for j in range(m):
            references[references.shape[0] - 1, j] = (y1[n1 + j] - y2[n2 + j]) * k_tot[j]
        plant, command = _filled(like[0], y1, 0), _filled(like[1], y1, n1)
        numerical, held = _filled(like[2], y2, 0), _filled(like[3], y2, n2)
        clocks = Clocks(t[0], t[1], t[2], t[3], t[4], t[5], t[6])
        _run(clocks, between, one, two, passing, notes, plant, command, numerical, held, step, out[i])
