"""Advance a loop whose plant has laws that are not linear, compiled.

Over a step the forces of the laws are polynomials in time: constant, or of third degree through their
values at the start and after each third (collocation, found by iteration). With such forces the motion is
exact; where it would leave a mode on the way, the step ends at the root of the motion's own series.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, inlined
from rthm_core.energy import GAUSS_NODES, GAUSS_WEIGHTS
from rthm_core.engine.nonlinear.steps import MOST_TERMS, ORDERS, at, fill
from rthm_core.engine.nonlinear.switch import expand, first_left, product
from rthm_core.physical.laws import (
    CODE,
    FRICTION,
    PARTITION,
    PLACE,
    STATE,
    STATES,
    plant_force,
    plant_rate,
)
from rthm_core.physical.switching import breakaway_mode, next_mode
from rthm_core.simd import WIDTH, simd_copy

TOLERANCE = 1e-8
"""What the neglected degree of a force may be, relative to the largest force that a law has had."""

FORCES_SETTLED = 1e-13
"""Change of the forces, relative likewise, at which the iteration ends."""

MOST_SWITCHES = 200
"""Switches within one step that are followed."""

SHORTEST_STEP = 1e-10
"""Shortest step, in s, that is halved no further."""


class Work(NamedTuple):
    """Scratch, and what lasts from step to step.

    Attributes
    ----------
    end : (d,) array
        [y, held, g] at the end of a step.
    y, base : (N,), (3, N) arrays
        State after a stage, and its part that does not depend on the forces.
    g : (4, G) array
        Forces at the start and after each third.
    polynomial : (orders, G) array
        Their coefficients over the step.
    terms : (MOST_TERMS + ORDERS, N) array
        Series of the motion.
    slope : (G,) array
        Rate of the forces at the end of the last step, from which the next iteration begins.
    scale : (1,) array
        Largest acceleration by a law.
    modes : (L,) array
        In force.
    moments : (d (d + 1) / 2,) array
        Integrals of the products of [y, held, g] over the last steps; empty where work is not counted.
    sums : (8,) array
        Work so far.
    """

    end: Floats
    y: Floats
    base: Floats
    g: Floats
    polynomial: Floats
    terms: Floats
    slope: Floats
    scale: Floats
    modes: Integers
    moments: Floats
    sums: Floats


def work(size: int, d: int, g: int, orders: int, modes: Integers, *, counting: bool) -> Work:
    """Work at the start of a test."""
    return Work(
        np.zeros(d),
        np.zeros(size),
        np.zeros((3, size)),
        np.zeros((4, g)),
        np.zeros((orders, g)),
        np.zeros((MOST_TERMS + ORDERS, size)),
        np.zeros(g),
        np.full(1, 1e-2),
        modes.copy(),
        np.zeros(d * (d + 1) // 2 if counting else 0),
        simd_copy(np.zeros(WIDTH)),
    )


@inlined
def _forces(laws, n, y, t, modes, out):  # type: ignore[no-untyped-def]
    """Forces of the laws and rates of their own states, at time `t` (s)."""
    own = laws.numbers.shape[0]
    for row in range(laws.numbers.shape[0]):
        states = laws.numbers[row, STATES]
        out[row] = 0.0
        for i in range(own, own + states):
            out[i] = 0.0
        if laws.numbers[row, PARTITION] != FRICTION or modes[row] != 0:
            dof, z, code = laws.numbers[row, PLACE], laws.numbers[row, STATE], laws.numbers[row, CODE]
            p = laws.parameters[row]
            out[row] = plant_force(code, y[dof], y[n + dof], y[z : z + states], t, p, modes[row])
            if states:
                rates = out[own : own + states]
                plant_rate(code, y[dof], y[n + dof], y[z : z + states], t, p, modes[row], rates)
        own += states


@inlined
def set_of(bits, modes):  # type: ignore[no-untyped-def]
    """Number of the set of dofs that stick."""
    number = 0
    for row in range(bits.size):
        if modes[row] == 0:
            number += bits[row]
    return number


@inlined
def begin_step(nonlinear, z, t, modes):  # type: ignore[no-untyped-def]
    """Forces at the start of a step, into `z`; what is held by more than its breakaway force comes loose.
    Returns the number of the set that sticks.
    """
    first = z.size - nonlinear.input_matrix.shape[1]
    for _ in range(2 * modes.size + 1):
        _forces(nonlinear.laws, nonlinear.n, z, t, modes, z[first:])
        number, loose, hold = set_of(nonlinear.bits, modes), -1, 0.0
        if number == 0:
            break
        for row in range(modes.size):
            if nonlinear.bits[row] and modes[row] == 0:
                held = product(nonlinear.holds[number, row], z)
                if abs(held) > nonlinear.laws.breakaway[row]:
                    loose, hold = row, held
        if loose < 0:
            break
        modes[loose] = breakaway_mode(hold)
    return number


@inlined
def step_by(matrix, z, count, out):  # type: ignore[no-untyped-def]
    """What the leading `count` rows of a matrix make of `z`."""
    for i in range(matrix.shape[1]):
        out[i] = matrix[0, i] * z[0]
    for j in range(1, count):
        for i in range(matrix.shape[1]):
            out[i] += matrix[j, i] * z[j]


@inlined
def _fit(g, polynomial):  # type: ignore[no-untyped-def]
    """Polynomial, in thirds of the step, through the forces."""
    for j in range(g.shape[1]):
        one, two = g[1, j] - g[0, j], g[2, j] - 2.0 * g[1, j] + g[0, j]
        three = g[3, j] - 3.0 * g[2, j] + 3.0 * g[1, j] - g[0, j]
        polynomial[0, j] = g[0, j]
        polynomial[1, j] = one - two / 2.0 + three / 3.0
        polynomial[2, j] = (two - three) / 2.0
        polynomial[3, j] = three / 6.0


@inlined
def _neglected(weight, g):  # type: ignore[no-untyped-def]
    """What a fourth degree of the forces would be, judged by how second and third follow one another."""
    worst = 0.0
    for j in range(g.shape[1]):
        two = abs(g[2, j] - 2.0 * g[1, j] + g[0, j])
        three = abs(g[3, j] - 3.0 * g[2, j] + 3.0 * g[1, j] - g[0, j])
        if three > 0.0:
            worst = max(worst, weight[j] * three * three / max(two, three))
    return worst


@inlined
def _stage(matrix, base, first, polynomial, y):  # type: ignore[no-untyped-def]
    """State after a stage of a step whose forces are known, into `y`."""
    row = first
    for i in range(y.size):
        y[i] = base[i]
    for r in range(polynomial.shape[0]):
        for j in range(polynomial.shape[1]):
            for i in range(y.size):
                y[i] += matrix[row, i] * polynomial[r, j]
            row += 1


@inlined
def _collocate(nonlinear, work, matrices, z, t, length):  # type: ignore[no-untyped-def]
    """Step with forces that change, to ``work.end``; whether the iteration settled and the degree does."""
    first, g, end = z.size - nonlinear.input_matrix.shape[1], work.g, work.end
    for j in range(g.shape[1]):
        for stage in range(4):
            g[stage, j] = z[first + j] + work.slope[j] * length * stage / 3.0
    for stage in range(3):
        step_by(matrices[stage], z, first, work.base[stage])
    settled = False
    for _ in range(12):
        _fit(g, work.polynomial)
        change = 0.0
        for stage in range(3):
            _stage(matrices[stage], work.base[stage], first, work.polynomial, work.y)
            after = t + length * (stage + 1) / 3.0
            _forces(nonlinear.laws, nonlinear.n, work.y, after, work.modes, end[first:])
            for j in range(g.shape[1]):
                change = max(change, abs(end[first + j] - g[stage + 1, j]) * nonlinear.weight[j])
                g[stage + 1, j] = end[first + j]
        settled = change <= FORCES_SETTLED * work.scale[0]
        if settled:
            break
    for i in range(work.y.size):
        end[i] = work.y[i]
    for j in range(g.shape[1]):
        work.slope[j] = (5.5 * g[3, j] - 9.0 * g[2, j] + 4.5 * g[1, j] - g[0, j]) / length if settled else 0.0
    return settled and _neglected(nonlinear.weight, g) <= TOLERANCE * work.scale[0]


@inlined
def _try(nonlinear, work, matrices, z, t, length):  # type: ignore[no-untyped-def]
    """Step of `length` from `z` to ``work.end``; whether it is good enough."""
    first, end = z.size - nonlinear.input_matrix.shape[1], work.end
    for j in range(nonlinear.systems.shape[1], z.size):
        end[j] = z[j]
    if not nonlinear.steady:
        for j in range(first, z.size):
            work.scale[0] = max(work.scale[0], abs(z[j]) * nonlinear.weight[j - first])
        return _collocate(nonlinear, work, matrices, z, t, length)
    step_by(matrices[0], z, z.size, end)
    return True


@inlined
def _count(nonlinear, work, terms, z, share, length):  # type: ignore[no-untyped-def]
    """Add the moments over a share of the step whose series is known."""
    first, point = z.size - nonlinear.input_matrix.shape[1], work.end
    for node in range(GAUSS_NODES.size):
        s = share * GAUSS_NODES[node]
        at(work.terms, terms, s, point)
        for j in range(work.polynomial.shape[1]):
            total = 0.0
            for r in range(work.polynomial.shape[0] - 1, -1, -1):
                total = total * s + work.polynomial[r, j]
            point[first + j] = total
        weight, pair = GAUSS_WEIGHTS[node] * share * length, 0
        for i in range(z.size):
            for j in range(i, z.size):
                work.moments[pair] += weight * point[i] * point[j]
                pair += 1


@inlined
def end_step(nonlinear, work, number, z, law, share, terms, length):  # type: ignore[no-untyped-def]
    """Count the moments of what is done of a step, and put its end into ``work.end`` if it is not there."""
    if work.moments.size:
        terms = terms if terms else expand(nonlinear, work, number, z, length)
        _count(nonlinear, work, terms, z, share, length)
    if law >= 0 or work.moments.size:
        at(work.terms, terms, share, work.end)


@inlined
def advance(nonlinear, steps, work, z, k, t):  # type: ignore[no-untyped-def]
    """Advance ``z = [y, held, g]`` over length `k`, from time `t` (s) on."""
    size, whole, lengths = nonlinear.systems.shape[1], steps.lengths[k], steps.lengths.size
    done, length, switches = 0.0, whole, 0
    while done < whole:
        number = begin_step(nonlinear, z, t + done, work.modes)
        slot = number * lengths + k if length == whole else steps.filled.size - 1
        if length != whole or not steps.filled[slot]:
            fill(nonlinear.systems[number], nonlinear.fastest, steps, slot, length)
            steps.filled[slot] = 1
        if not _try(nonlinear, work, steps.matrices[slot], z, t + done, length) and length > SHORTEST_STEP:
            length *= 0.5
            continue
        law, share, terms = -1, 1.0, 0
        if switches < MOST_SWITCHES:
            law, share, terms = first_left(nonlinear, work, number, z, length)
        end_step(nonlinear, work, number, z, law, share, terms, length)
        if law >= 0:
            hold = product(nonlinear.holds[number, law], work.end)
            mode = work.modes[law]
            work.modes[law] = next_mode(nonlinear.laws, nonlinear.n, law, mode, work.end, hold)
            switches += 1
        for i in range(size):
            z[i] = work.end[i]
        done = whole if law < 0 and done + length >= whole else done + share * length
        length = min(whole - done, 2.0 * length) if law < 0 else whole - done
    _forces(
        nonlinear.laws, nonlinear.n, z, t + whole, work.modes, z[z.size - nonlinear.input_matrix.shape[1] :]
    )
