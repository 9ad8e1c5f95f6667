"""Where on its way a motion leaves the mode of a law, compiled: by the series of the motion over a step."""

from __future__ import annotations

from rthm_core.compiled import inlined
from rthm_core.engine.nonlinear.steps import at, series
from rthm_core.physical.laws import FRICTION, NONE, PARTITION, PLACE, POSITION
from rthm_core.physical.switching import between, guard, narrowed


@inlined
def product(row, z):  # type: ignore[no-untyped-def]
    """Scalar product with the leading elements of `z`."""
    total = 0.0
    for j in range(row.size):
        total += row[j] * z[j]
    return total


@inlined
def _guard(nonlinear, number, row, mode, z):  # type: ignore[no-untyped-def]
    """Margin of a law, with the force that holds its dof if it sticks."""
    hold = 0.0
    if mode == 0 and nonlinear.laws.numbers[row, PARTITION] == FRICTION:
        hold = product(nonlinear.holds[number, row], z)
    return guard(nonlinear.laws, nonlinear.n, row, mode, z, hold)


@inlined
def _turning(nonlinear, number, row, z):  # type: ignore[no-untyped-def]
    """What vanishes where the guard of a law is least: velocity, or acceleration, of its dof."""
    velocity = nonlinear.laws.numbers[row, PLACE] + nonlinear.n
    value = z[velocity]
    if nonlinear.laws.numbers[row, PARTITION] != POSITION:
        value = product(nonlinear.systems[number, velocity], z)
    return value


@inlined
def _dips(nonlinear, number, row, mode, z, end):  # type: ignore[no-untyped-def]
    """Whether a law may have left its mode and come back to it within the step."""
    partition = nonlinear.laws.numbers[row, PARTITION]
    if partition == POSITION:
        return _turning(nonlinear, number, row, z) * _turning(nonlinear, number, row, end) < 0.0
    if partition == NONE or mode == 0 or mode * _turning(nonlinear, number, row, end) <= 0.0:
        return False
    return mode * _turning(nonlinear, number, row, z) < 0.0


@inlined
def stays(nonlinear, number, modes, z, end):  # type: ignore[no-untyped-def]
    """Whether no law may have left its mode within the step from z to `end`."""
    for row in range(modes.size):
        if _guard(nonlinear, number, row, modes[row], end) < 0.0:
            return False
        if _dips(nonlinear, number, row, modes[row], z, end):
            return False
    return True


@inlined
def _least(nonlinear, work, number, row, terms):  # type: ignore[no-untyped-def]
    """Share of the step at which the guard of a law is least; the state there is left in ``work.end``."""
    low, high = 0.0, 1.0
    at(work.terms, terms, 1.0, work.end)
    sign = 1.0 if _turning(nonlinear, number, row, work.end) > 0.0 else -1.0
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        at(work.terms, terms, middle, work.end)
        if sign * _turning(nonlinear, number, row, work.end) > 0.0:
            high = middle
        else:
            low = middle
    return low


@inlined
def _root(nonlinear, work, number, row, terms, high):  # type: ignore[no-untyped-def]
    """First share of the step at which a law has left its mode, which it has at `high` (Illinois method)."""
    mode, low, at_low = work.modes[row], 0.0, 0.0
    at(work.terms, terms, high, work.end)
    at_high = _guard(nonlinear, number, row, mode, work.end)
    for _ in range(100):
        if high - low <= 1e-14:
            break
        middle = between(low, high, at_low, at_high)
        at(work.terms, terms, middle, work.end)
        value = _guard(nonlinear, number, row, mode, work.end)
        low, high, at_low, at_high = narrowed(low, high, at_low, at_high, middle, value)
    return high


@inlined
def expand(nonlinear, work, number, z, length):  # type: ignore[no-untyped-def]
    """Series of the motion over the step just tried; its number of terms."""
    factor, g = 1.0, work.force.size
    first = z.size - g
    for r in range(work.polynomial.shape[0]):
        for j in range(work.polynomial.shape[1]):
            coefficient = z[first + j] if nonlinear.steady else work.whole[first + r * g + j]
            work.polynomial[r, j] = coefficient * factor
        factor *= 3.0
    return series(nonlinear.systems[number], nonlinear.fastest, length, z, work.polynomial, work.terms)


@inlined
def first_left(nonlinear, work, number, z, length):  # type: ignore[no-untyped-def]
    """First law that leaves its mode within the step just tried (-1: none), the share of the step at which
    it does, and the number of terms of the series (0: not needed).
    """
    terms, law, share = 0, -1, 1.0
    for row in range(work.modes.size):
        mode, end = work.modes[row], 1.0
        left = _guard(nonlinear, number, row, mode, work.end) < 0.0
        if not left and not _dips(nonlinear, number, row, mode, z, work.end):
            continue
        if terms == 0:
            terms = expand(nonlinear, work, number, z, length)
        if not left:
            end = _least(nonlinear, work, number, row, terms)
            left = _guard(nonlinear, number, row, mode, work.end) < 0.0
        if left:
            root = _root(nonlinear, work, number, row, terms, end)
            if root < share or law < 0:
                law, share = row, root
        at(work.terms, terms, 1.0, work.end)
    return law, share, terms
