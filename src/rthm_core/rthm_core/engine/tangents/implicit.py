"""Tangents of forces that follow from the motion which they drive, compiled.

Where the forces after each third of a step have settled, their tangents follow from one linear system, the
same for all parameters: ``dg = J dy + b`` with ``dy = dy0 + T dg``, where J is how forces change with what
laws feel, b what parameters change of them by themselves, dy0 the tangents of what is felt if no force after
the start of the step had any, and T the influence of these forces.
"""

from __future__ import annotations

from rthm_core.compiled import inlined, whole
from rthm_core.engine.nonlinear.steps import ORDERS
from rthm_core.engine.tangents.polynomial import FIT, STAGES
from rthm_core.engine.tangents.slopes import find_slopes
from rthm_core.simd import element, numbers, put_element, put_numbers


@inlined
def force_tangents(nonlinear, tangents, ask, z, t, modes, dz, groups):  # type: ignore[no-untyped-def]
    """Tangents of the forces at z and time `t` (s), into the last elements of those of z."""
    find_slopes(nonlinear, tangents, ask, z, t, modes, groups)
    slopes, beside, places, first = ask.slopes, ask.beside, ask.places, z.size - ask.slopes.shape[0]
    for force in range(slopes.shape[0]):
        for group in range(len(groups)):
            total = numbers(beside, (force, group))
            for i in range(places.size):
                total += numbers(dz, (element(places, (i,)), group)) * element(slopes, (force, i))
            put_numbers(dz, (first + force, group), total)


@inlined
def _equations(  # type: ignore[no-untyped-def]
    slopes, beside, places, stage, influence, felt, dz, matrix, right, groups
):
    """Equations for the forces after a third: rows of the matrix and right-hand sides."""
    g, count = slopes.shape[0], influence.shape[0] // STAGES
    for force in range(g):
        row = stage * g + force
        for column in range(STAGES * g):
            total = 1.0 if column == row else 0.0
            for i in range(count):
                total -= element(slopes, (force, i)) * element(influence, (stage * count + i, column))
            put_element(matrix, (row, column), total)
        for group in range(len(groups)):
            known = numbers(beside, (force, group))
            for i in range(count):
                known += numbers(felt, (stage * count + i, group)) * element(slopes, (force, i))
            for i in range(count, places.size):
                known += numbers(dz, (element(places, (i,)), group)) * element(slopes, (force, i))
            put_numbers(right, (row, group), known)


@inlined
def _less(right, row, other, factor, groups):  # type: ignore[no-untyped-def]
    """Take a multiple of another row away from one."""
    for group in range(len(groups)):
        rest = numbers(right, (row, group)) - numbers(right, (other, group)) * factor
        put_numbers(right, (row, group), rest)


@inlined
def solve_in_place(matrix, right, groups):  # type: ignore[no-untyped-def]
    """Solve for all right-hand sides (., Q, 8) in place. Rows stay in their order: the matrix is one that an
    iteration has settled with, near the unit matrix.
    """
    size = matrix.shape[0]
    for i in range(size):
        inverse = 1.0 / element(matrix, (i, i))
        put_element(matrix, (i, i), inverse)
        for row in range(i + 1, size):
            factor = element(matrix, (row, i)) * inverse
            for column in range(i + 1, size):
                rest = element(matrix, (row, column)) - factor * element(matrix, (i, column))
                put_element(matrix, (row, column), rest)
            _less(right, row, i, factor, groups)
    for i in range(size - 1, -1, -1):
        for column in range(i + 1, size):
            _less(right, i, column, element(matrix, (i, column)), groups)
        for group in range(len(groups)):
            put_numbers(right, (i, group), numbers(right, (i, group)) * element(matrix, (i, i)))


@inlined
def begin_polynomial(dwhole, first, g, groups):  # type: ignore[no-untyped-def]
    """Tangents of the coefficients of forces that have none but at the start of the step."""
    for force in range(g):
        for group in range(len(groups)):
            start = numbers(dwhole, (first + force, group))
            for order in range(1, ORDERS):
                put_numbers(dwhole, (first + order * g + force, group), start * FIT[order, 0])


@inlined
def add_polynomial(dwhole, first, g, found, groups):  # type: ignore[no-untyped-def]
    """Add what the forces after each third make of them."""
    for force in range(g):
        for group in range(len(groups)):
            one, two, three = (
                numbers(found, (force, group)),
                numbers(found, (g + force, group)),
                numbers(found, (2 * g + force, group)),
            )
            for order in range(1, ORDERS):
                row = first + order * g + force
                total = numbers(dwhole, (row, group)) + one * FIT[order, 1]
                put_numbers(dwhole, (row, group), total + two * FIT[order, 2] + three * FIT[order, 3])


@whole
def solve_forces(  # type: ignore[no-untyped-def]
    nonlinear, tangents, work, own, slot, influence, half, t, third, groups
):
    """Tangents of the forces over a step that has settled, from those of what is felt without them: after
    each third into ``own.forces``, and of their coefficients into a half of ``own.halves``.
    """
    ask, felt, matrix, found, dwhole = own.ask, own.felt, own.matrix, own.forces, own.halves[half]
    y, motion, places, modes, g = work.y, work.felt, nonlinear.felt, work.modes, work.force.size
    first, slopes, beside, asked = own.now.size - g, ask.slopes, ask.beside, ask.places
    for stage in range(STAGES):
        for i in range(places.size):
            put_element(y, (element(places, (i,)),), motion[stage * places.size + i])
        find_slopes(nonlinear, tangents, ask, y, t + third * (stage + 1), modes, groups)
        _equations(slopes, beside, asked, stage, influence[slot], felt, dwhole, matrix, found, groups)
    solve_in_place(matrix, found, groups)
    add_polynomial(dwhole, first, g, found, groups)
