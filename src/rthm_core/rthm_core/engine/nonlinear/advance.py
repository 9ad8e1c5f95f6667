"""Advance a loop whose plant has laws that are not linear, compiled.

Over a step the forces of the laws are polynomials in time: constant, or of third degree through their
values at the start and after each third (collocation, found by iteration). With such forces the motion is
exact; where it would leave a mode on the way, the step ends at the root of the motion's own series.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, inlined, whole
from rthm_core.energy import GAUSS_NODES, GAUSS_WEIGHTS
from rthm_core.engine.nonlinear.collocation import collocate
from rthm_core.engine.nonlinear.forces import forces
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.nonlinear.packed import end_of, prepare
from rthm_core.engine.nonlinear.steps import MOST_TERMS, ORDERS, at
from rthm_core.engine.nonlinear.switch import expand, first_left, product
from rthm_core.engine.worked import put_products, weighed
from rthm_core.lent import given, lent
from rthm_core.physical.switching import breakaway_mode, next_mode
from rthm_core.simd import WIDTH, numbers, put_numbers, simd_copy

MOST_SWITCHES = 200
"""Switches within one step that are followed."""

SHORTEST_STEP = 1e-10
"""Shortest step, in s, that is halved no further."""

REST_OF_ROUNDING = 1e-12
"""Part of a length that is none: what rounding leaves of it."""


class Work(NamedTuple):
    """Scratch, and what lasts from step to step.

    Attributes
    ----------
    end : (d,) array
        [y, held, g] at the end of a step.
    y : (N + M,) array
        State after a stage, as far as the laws feel it, and held inputs.
    felt, base : (P 8,), (P, 8) arrays
        What they feel after all stages, and the part of that which does not depend on the forces.
    wide, seen : (Q 8,), (V 8,) arrays
        State after a step, and what is seen of it.
    force : (G,) array
        Forces after a stage.
    g : (4, G) array
        Forces at the start and after each third.
    polynomial : (orders, G) array
        Their coefficients over the step.
    terms : (MOST_TERMS + ORDERS, N) array
        Series of the motion.
    whole, part : (N + M + orders G,) arrays
        What describes all of a step: [y, held] at its start, and the polynomial; and a leading part of it.
    trend : (3, G) array
        How the forces go on after the last step, by powers of the time in s: where the next iteration begins.
    pace : (1,) array
        Longest step over which forces that change are believed to be of third degree, in s.
    contraction : (1,) array
        By what an iteration made the change of the forces smaller, when this was last seen.
    scale : (1,) array
        Largest acceleration by a law.
    modes : (L,) array
        In force.
    moments : (d (d + 1) / 2,) array
        Integrals of the products of [y, held, g] over the last steps; empty where work is not counted.
    products : (P,) array
        Those of every two numbers of what describes a step or a part of it; empty likewise.
    sums, before : (8,) arrays
        Work so far and, on the way through an arc, the energy; and those before the present arc.
    """

    end: Floats
    y: Floats
    felt: Floats
    base: Floats
    wide: Floats
    seen: Floats
    force: Floats
    g: Floats
    polynomial: Floats
    terms: Floats
    whole: Floats
    part: Floats
    trend: Floats
    pace: Floats
    contraction: Floats
    scale: Floats
    modes: Integers
    moments: Floats
    products: Floats
    sums: Floats
    before: Floats


def work(nonlinear: Nonlinear, seen: int, *, counting: bool) -> Work:
    """Work at the start of a test, of which `seen` numbers are seen."""
    _, size, d = nonlinear.systems.shape
    g, orders = nonlinear.weight.size, 1 if nonlinear.steady else ORDERS
    whole = d + (orders - 1) * g
    felt, after = -(-3 * nonlinear.felt.size // WIDTH), -(-size // WIDTH)
    lengths = [felt, felt, after, seen // WIDTH, 1, 1]
    wide = simd_copy(np.zeros((sum(lengths), WIDTH)))
    ends = np.cumsum(lengths).tolist()
    stages, base, end, looks, sums, before = (
        wide[last - length : last] for length, last in zip(lengths, ends, strict=True)
    )
    return Work(
        np.zeros(d),
        np.zeros(d - g),
        stages.ravel(),
        base,
        end.ravel(),
        looks.ravel(),
        np.zeros(g),
        np.zeros((4, g)),
        np.zeros((orders, g)),
        np.zeros((MOST_TERMS + ORDERS, size)),
        np.zeros(whole),
        np.zeros(whole),
        np.zeros((3, g)),
        np.full(1, np.inf),
        np.ones(1),
        np.full(1, 1e-2),
        nonlinear.modes.copy(),
        np.zeros(d * (d + 1) // 2 if counting else 0),
        np.zeros(whole * (whole + 1) // 2 if counting else 0),
        sums.ravel(),
        before.ravel(),
    )


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
        forces(nonlinear, z, t, modes, z[first:])
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
def try_step(nonlinear, packed, work, slot, z, t, length):  # type: ignore[no-untyped-def]
    """Step of `length` from `z` to ``work.end``; whether it is good enough."""
    size = nonlinear.systems.shape[1]
    for j in range(size, z.size):
        work.end[j] = z[j]
    if not nonlinear.steady:
        return collocate(nonlinear, packed, work, slot, z, t, length)
    end_of(packed, slot, z, work.wide, work.end[:size])
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


@called
def _add_work(tables, slot, products, before, sums):  # type: ignore[no-untyped-def]
    """See `count_work`; by itself, so that loops whose work is not counted are none the slower for it."""
    put_numbers(sums, (), numbers(before, ()) + weighed(tables, slot, products))


@inlined
def count_work(nonlinear, tables, number, k, products, before, sums):  # type: ignore[no-untyped-def]
    """Work over length `k` of a motion by its `products`, added to that `before`, into `sums`."""
    slot = number * (tables.shape[0] // nonlinear.systems.shape[0]) + k
    _add_work(tables, slot, products, before, sums)


@inlined
def count_step(nonlinear, tables, work, number, k, halvings):  # type: ignore[no-untyped-def]
    """Add the work over a whole length from its table; whether there is one."""
    if halvings or nonlinear.steady or not tables.shape[0]:
        return False
    put_products(work.whole, work.products)
    count_work(nonlinear, tables, number, k, work.products, work.sums, work.sums)
    return True


@inlined
def halvings_of(lengths, packed, k, fewest, limit):  # type: ignore[no-untyped-def]
    """How often length `k` is halved, at least `fewest` times, to be no longer than `limit`; as often as
    there are halves at most.
    """
    halvings, most = fewest, lengths.size // packed.whole - 1
    while halvings < most and lengths[k + halvings * packed.whole] > limit:
        halvings += 1
    return halvings


@inlined
def shorter(lengths, packed, k, halvings, length, pace):  # type: ignore[no-untyped-def]
    """Halvings of length `k`, -1: any other length, and length of a step after one that was no good."""
    fewest, most = halvings + 1, lengths.size // packed.whole - 1
    halvings = halvings_of(lengths, packed, k, fewest, pace) if 0 < fewest <= most else -1
    return halvings, lengths[k + halvings * packed.whole] if halvings >= 0 else 0.5 * length


@inlined
def following(lengths, packed, k, halvings, length, left, pace):  # type: ignore[no-untyped-def]
    """Likewise for one that follows a good one, of no more than what is left of length `k`."""
    if halvings < 0:
        return halvings, min(left, 2.0 * length)
    limit = min(left * (1.0 + REST_OF_ROUNDING), pace)
    halvings = halvings_of(lengths, packed, k, max(halvings - 1, 0), limit)
    return halvings, lengths[k + halvings * packed.whole]


@whole
def advance(nonlinear, steps, packed, work, z, k, t):  # type: ignore[no-untyped-def]
    """Advance ``z = [y, held, g]`` over length `k`, from time `t` (s) on.

    Steps are halves of the length, and halves of these, until a law switches: from there on they have any
    length.
    """
    nonlinear, steps = lent(given(nonlinear)), lent(given(steps))
    packed, work = lent(given(packed)), lent(given(work))
    size, lengths, kinds = nonlinear.systems.shape[1], steps.lengths, steps.lengths.size
    whole = lengths[k]
    halvings, done, switches = halvings_of(lengths, packed, k, 0, work.pace[0]), 0.0, 0
    length = lengths[k + halvings * packed.whole]
    while done < whole:
        number = begin_step(nonlinear, z, t + done, work.modes)
        slot = number * kinds + k + halvings * packed.whole if halvings >= 0 else packed.filled.size - 1
        prepare(nonlinear, steps, packed, number, slot, length)
        if not try_step(nonlinear, packed, work, slot, z, t + done, length) and length > SHORTEST_STEP:
            halvings, length = shorter(lengths, packed, k, halvings, length, work.pace[0])
            continue
        law, share, terms = -1, 1.0, 0
        if switches < MOST_SWITCHES:
            law, share, terms = first_left(nonlinear, work, number, z, length)
        if law >= 0 or not count_step(nonlinear, steps.work_tables, work, number, k, halvings):
            end_step(nonlinear, work, number, z, law, share, terms, length)
        if law >= 0:
            hold = product(nonlinear.holds[number, law], work.end)
            mode = work.modes[law]
            work.modes[law] = next_mode(nonlinear.laws, nonlinear.n, law, mode, work.end, hold)
            switches += 1
        for i in range(size):
            z[i] = work.end[i]
        done = done + share * length
        if law >= 0:
            halvings, length = -1, whole - done
            continue
        if whole - done <= REST_OF_ROUNDING * whole:
            break
        halvings, length = following(lengths, packed, k, halvings, length, whole - done, work.pace[0])
    forces(nonlinear, z, t + whole, work.modes, z[z.size - work.force.size :])
