"""Steps in which forces are constant and nothing switches, compiled: most steps of a loop with dry friction.

Arrays are handed over one by one, which compiles to less than tuples of them.
"""

from __future__ import annotations

from rthm_core.compiled import inlined
from rthm_core.engine.nonlinear.switch import product
from rthm_core.engine.worked import worked
from rthm_core.physical.laws import PLACE
from rthm_core.simd import numbers, put_numbers


@inlined
def _after(row, z, end):  # type: ignore[no-untyped-def]
    """Product of a row with z at the end of a step, whose inputs are those at its start."""
    total = 0.0
    for j in range(z.size):
        total += row[j] * (end[j] if j < end.size else z[j])
    return total


@inlined
def _holds_on(holds, limit, z, end):  # type: ignore[no-untyped-def]
    """Whether a dof that sticks is held by at most `limit` at the start and the end of a step."""
    return abs(product(holds, z)) <= limit and abs(_after(holds, z, end)) <= limit


@inlined
def _moves_on(slope, velocity, mode, z, end):  # type: ignore[no-untyped-def]
    """Whether a dof that slips still does so at the end of a step, and has not turned in between."""
    if mode * end[velocity] < 0.0:
        return False
    return mode * _after(slope, z, end) <= 0.0 or mode * product(slope, z) >= 0.0


@inlined
def nothing_switches(  # type: ignore[no-untyped-def]
    systems, holds, number, places, n, breakaway, z, modes, end
):
    """Whether all dofs stick on, or slip on, over a step from ``z = [y, held, g]`` to the states `end`."""
    for row in range(modes.size):
        mode, velocity = modes[row], places[row, PLACE] + n
        if mode == 0 and not _holds_on(holds[number, row], breakaway[row], z, end):
            return False
        if mode != 0 and not _moves_on(systems[number, velocity], velocity, mode, z, end):
            return False
    return True


@inlined
def event_free_step(  # type: ignore[no-untyped-def]
    systems,
    holds,
    bits,
    places,
    n,
    breakaway,
    matrices,
    filled,
    lengths,
    work_tables,
    k,
    z,
    modes,
    end,
    sums,
):
    """States (N,) `end` after a step over length `k` from ``z = [y, held, g]`` on; whether it may be taken,
    which it may not where anything switches. Work is added to `sums` (8,) where it is counted.
    """
    number = 0
    for row in range(modes.size):
        number += bits[row] if modes[row] == 0 else 0
    slot = number * lengths.size + k
    if not filled[slot]:
        return False
    for i in range(end.size):
        total = 0.0
        for j in range(z.size):
            total += matrices[slot, 0, j, i] * z[j]
        end[i] = total
    if not nothing_switches(systems, holds, number, places, n, breakaway, z, modes, end):
        return False
    if work_tables.shape[0]:
        put_numbers(sums, (), numbers(sums, ()) + worked(work_tables, slot, z))
    return True
