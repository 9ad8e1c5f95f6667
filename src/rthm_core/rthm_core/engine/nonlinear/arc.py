"""A motion over a whole arc as one step, and what it is on the way, compiled: most arcs of most loops."""

from __future__ import annotations

from rthm_core.compiled import copy_into, inlined
from rthm_core.energy import TERMS
from rthm_core.engine.nonlinear.advance import count_work, set_of
from rthm_core.engine.nonlinear.collocation import collocate
from rthm_core.engine.nonlinear.event_free import nothing_switches
from rthm_core.engine.nonlinear.packed import end_of, prepare, wide_product
from rthm_core.engine.nonlinear.steps import ORDERS
from rthm_core.engine.nonlinear.switch import product, stays
from rthm_core.engine.worked import put_products
from rthm_core.physical.laws import FRICTION, PARTITION

ENERGY = len(TERMS)
"""Where the energy stands beside the work."""


@inlined
def _turns(nonlinear, number, row, z, end):  # type: ignore[no-untyped-def]
    """Whether the force that holds a sticking dof is largest between the ends of a step."""
    holds, system, before, after = nonlinear.holds[number, row], nonlinear.systems[number], 0.0, 0.0
    for i in range(system.shape[0]):
        before += holds[i] * product(system[i], z)
        after += holds[i] * product(system[i], end)
    return before * after < 0.0


@inlined
def sticks_on(nonlinear, number, modes, z, end):  # type: ignore[no-untyped-def]
    """Whether no force that holds a dof is larger on the way than at the ends of a step."""
    for row in range(modes.size):
        sticking = modes[row] == 0 and nonlinear.laws.numbers[row, PARTITION] == FRICTION
        if sticking and _turns(nonlinear, number, row, z, end):
            return False
    return True


@inlined
def _comes_loose(nonlinear, number, modes, z):  # type: ignore[no-untyped-def]
    """Whether something that sticks is held by more than its breakaway force."""
    for row in range(modes.size if number else 0):
        held = abs(product(nonlinear.holds[number, row], z))
        if nonlinear.bits[row] and modes[row] == 0 and held > nonlinear.laws.breakaway[row]:
            return True
    return False


@inlined
def before_arc(work, z, steady):  # type: ignore[no-untyped-def]
    """Keep the work before an arc from z on, and the products that describe it where forces are `steady`."""
    if work.products.size:
        copy_into(work.before, work.sums)
        work.before[ENERGY] = 0.0  # which is no sum
        if steady:
            put_products(z, work.products)


@inlined
def begin_arc(nonlinear, steps, packed, work, z, k, t):  # type: ignore[no-untyped-def]
    """Find the motion over length `k` from z on, from time `t` (s) on: it is described by ``work.whole``, its
    end is in ``work.end``. Returns the number of the set that sticks, or -1 where something switches on the
    way or the step is too long.
    """
    number = set_of(nonlinear.bits, work.modes)
    if not nonlinear.steady and steps.lengths[k] > work.pace[0]:
        return -1
    if not nonlinear.steady and _comes_loose(nonlinear, number, work.modes, z):
        return -1
    slot = number * steps.lengths.size + k
    prepare(nonlinear, steps, packed, number, slot, steps.lengths[k])
    for j in range(nonlinear.systems.shape[1], z.size):
        work.end[j] = z[j]
    if nonlinear.steady:
        copy_into(work.whole, z)
        end_of(packed, slot, z, work.wide, work.end[: nonlinear.systems.shape[1]])
        good = nothing_switches(
            nonlinear.systems, nonlinear.holds, number, nonlinear.laws.numbers, nonlinear.n,
            nonlinear.laws.breakaway, z, work.modes, work.end,
        )  # fmt: skip
    else:
        good = collocate(nonlinear, packed, work, slot, z, t, steps.lengths[k])
        good = good and stays(nonlinear, number, work.modes, z, work.end)
    before_arc(work, z, nonlinear.steady)
    return number if good and sticks_on(nonlinear, number, work.modes, z, work.end) else -1


@inlined
def part_of(whole, g, share, part):  # type: ignore[no-untyped-def]
    """What describes a leading `share` of an arc over which `g` forces are polynomials."""
    row, factor = whole.size - (ORDERS - 1) * g, share
    for j in range(row):
        part[j] = whole[j]
    while row < whole.size:
        for j in range(row, row + g):
            part[j] = whole[j] * factor
        row += g
        factor *= share


@inlined
def within_arc(nonlinear, steps, packed, work, number, k, span):  # type: ignore[no-untyped-def]
    """What is seen a length `span` after the beginning of an arc over length `k`, into ``work.seen``."""
    slot = number * steps.lengths.size + span
    prepare(nonlinear, steps, packed, number, slot, steps.lengths[span])
    if nonlinear.steady:
        wide_product(packed.seen, slot, work.whole, work.seen)
    else:
        part_of(work.whole, work.force.size, steps.lengths[span] / steps.lengths[k], work.part)
        wide_product(packed.seen, slot, work.part, work.seen)


@inlined
def count_within(nonlinear, steps, work, number, span):  # type: ignore[no-untyped-def]
    """Work and energy where an arc was last looked at, a length `span` after its beginning, into
    ``work.sums``.
    """
    if not nonlinear.steady:
        put_products(work.part, work.products)
    count_work(nonlinear, steps.work_tables, number, span, work.products, work.before, work.sums)


@inlined
def end_arc(nonlinear, steps, work, number, k, z):  # type: ignore[no-untyped-def]
    """The motion at the end of an arc over length `k`, into z, and the work so far."""
    tables = steps.work_tables
    for j in range(z.size):
        z[j] = work.end[j]
    if tables.shape[0]:
        if not nonlinear.steady:
            put_products(work.whole, work.products)
        count_work(nonlinear, tables, number, k, work.products, work.before, work.sums)
