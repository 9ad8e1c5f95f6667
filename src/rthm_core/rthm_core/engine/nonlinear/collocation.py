"""A step over which the forces of the laws are polynomials of third degree in time, compiled.

They go through the forces at the start and after each third of the step, which are found by iteration; with
them the motion is exact. Of each stage's motion only what the laws feel is computed.
"""

from __future__ import annotations

import math

from rthm_core.compiled import inlined, whole
from rthm_core.engine.nonlinear.forces import forces
from rthm_core.engine.nonlinear.packed import end_of
from rthm_core.lent import given, lent
from rthm_core.simd import WIDTH, everywhere, numbers, put_numbers, put_numbers_from

TOLERANCE = 1e-8
"""What the neglected degree of a force may be, relative to the largest force that a law has had."""

FORCES_SETTLED = 1e-13
"""Change of the forces that one more iteration would make, relative likewise, at which they are taken."""

BEST_CONTRACTION = 1e-2
"""What the first iteration of a step is believed to leave of an error, at the least."""

MOST_FORCE_ITERATIONS = 12

LONGEST_GROWTH, CAUTION = 4.0, 0.9
"""By how much a step may be longer than the last, at the most, and the part of the length that would just do
which is believed in.
"""


@inlined
def _predict(trend, z, first, third, g):  # type: ignore[no-untyped-def]
    """Forces after each third of a step, as they would be if they went on as they did."""
    for j in range(g.shape[1]):
        for stage in range(4):
            ahead = stage * third
            change = ((trend[2, j] * ahead + trend[1, j]) * ahead + trend[0, j]) * ahead
            g[stage, j] = z[first + j] + change


@inlined
def _fit(g, first, whole):  # type: ignore[no-untyped-def]
    """Polynomial, in thirds of the step, through the forces, into `whole` from place `first` on."""
    count = g.shape[1]
    for j in range(count):
        one, two = g[1, j] - g[0, j], g[2, j] - 2.0 * g[1, j] + g[0, j]
        three = g[3, j] - 3.0 * g[2, j] + 3.0 * g[1, j] - g[0, j]
        whole[first + j] = g[0, j]
        whole[first + count + j] = one - two / 2.0 + three / 3.0
        whole[first + 2 * count + j] = (two - three) / 2.0
        whole[first + 3 * count + j] = three / 6.0


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
def _without_forces(stages, slot, first, whole, base):  # type: ignore[no-untyped-def]
    """Part of what is felt after all stages that does not depend on the forces."""
    for group in range(stages.shape[2]):
        total = everywhere(0.0)
        for j in range(first):
            total += numbers(stages, (slot, j, group)) * whole[j]
        put_numbers(base, (group,), total)


@inlined
def _with_forces(stages, slot, first, whole, base, felt):  # type: ignore[no-untyped-def]
    """What is felt after all stages of a step whose forces are known."""
    for group in range(stages.shape[2]):
        total = numbers(base, (group,))
        for j in range(first, whole.size):
            total += numbers(stages, (slot, j, group)) * whole[j]
        put_numbers_from(felt, group * WIDTH, total)


@inlined
def _iterate(nonlinear, stages, work, slot, first, t, third):  # type: ignore[no-untyped-def]
    """Forces that follow from the motion under the present ones; the largest change of any."""
    change, places = 0.0, nonlinear.felt
    _fit(work.g, first, work.whole)
    _with_forces(stages, slot, first, work.whole, work.base, work.felt)
    for stage in range(3):
        for i in range(places.size):
            work.y[places[i]] = work.felt[stage * places.size + i]
        forces(nonlinear, work.y, t + third * (stage + 1), work.modes, work.force)
        for j in range(work.force.size):
            change = max(change, abs(work.force[j] - work.g[stage + 1, j]) * nonlinear.weight[j])
            work.g[stage + 1, j] = work.force[j]
    return change


@inlined
def _settle(nonlinear, stages, work, slot, first, t, third):  # type: ignore[no-untyped-def]
    """Iterate until the forces do not change; whether they came to that."""
    enough, before, settled = FORCES_SETTLED * work.scale[0], 0.0, False
    contraction = max(work.contraction[0], BEST_CONTRACTION)
    for _ in range(MOST_FORCE_ITERATIONS):
        change = _iterate(nonlinear, stages, work, slot, first, t, third)
        if before > 0.0:
            contraction = work.contraction[0] = min(change / before, 1.0)
        settled = change * contraction <= enough
        if settled:
            break
        before = change
    return settled


@inlined
def _keep(whole, first, third, trend):  # type: ignore[no-untyped-def]
    """How the forces go on at the end of a step, by powers of the time in s."""
    count, inverse = trend.shape[1], 1.0 / third
    for j in range(count):
        one, two = whole[first + count + j], whole[first + 2 * count + j]
        three = whole[first + 3 * count + j]
        trend[0, j] = (one + 6.0 * two + 27.0 * three) * inverse
        trend[1, j] = (two + 9.0 * three) * inverse * inverse
        trend[2, j] = three * inverse * inverse * inverse


@whole
def collocate(nonlinear, packed, work, slot, z, t, length):  # type: ignore[no-untyped-def]
    """Step with forces that change: from z to ``work.end``, and what describes all of it to ``work.whole``;
    whether the iteration settled and the degree is high enough.
    """
    nonlinear, packed, work = lent(given(nonlinear)), lent(given(packed)), lent(given(work))
    first, third = z.size - work.force.size, length / 3.0
    for j in range(work.force.size):
        work.scale[0] = max(work.scale[0], abs(z[first + j]) * nonlinear.weight[j])
    for j in range(first):
        work.whole[j] = work.y[j] = z[j]
    _predict(work.trend, z, first, third, work.g)
    _without_forces(packed.stages, slot, first, work.whole, work.base)
    settled = _settle(nonlinear, packed.stages, work, slot, first, t, third)
    _fit(work.g, first, work.whole)
    _keep(work.whole, first, third, work.trend)
    work.pace[0] = 0.5 * length
    if not settled:
        for j in range(work.force.size):
            work.trend[0, j] = work.trend[1, j] = work.trend[2, j] = 0.0
        return False
    end_of(packed, slot, work.whole, work.wide, work.end[: nonlinear.systems.shape[1]])
    for j in range(work.force.size):
        work.end[first + j] = work.g[3, j]
    part = _neglected(nonlinear.weight, work.g) / (TOLERANCE * work.scale[0])
    work.pace[0] = length * min(LONGEST_GROWTH, CAUTION / math.sqrt(math.sqrt(part)))
    return part <= 1.0
