"""Whether nothing switches over a step in which forces are constant, compiled: so it is in most steps of a
loop with dry friction.

Arrays are handed over one by one, which compiles to less than tuples of them.
"""

from __future__ import annotations

from rthm_core.compiled import inlined
from rthm_core.engine.nonlinear.switch import product
from rthm_core.physical.laws import PLACE


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
