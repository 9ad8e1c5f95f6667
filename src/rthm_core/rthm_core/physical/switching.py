"""In which mode a law begins, when it leaves it, how that is narrowed down, and which mode follows."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import inlined
from rthm_core.physical.laws import FRICTION, OTHER, PARTITION, PLACE, POSITION, TIME, VELOCITY

SAME_INSTANT = 1e-12
"""Time, s, before an instant from which on it has come: no step is that short."""


@inlined
def motion_of(laws, n, row, y):  # type: ignore[no-untyped-def]
    """Position and velocity that a law gets: of its dof, or of that less another."""
    dof, other = laws.numbers[row, PLACE], laws.numbers[row, OTHER]
    x, v = y[dof], y[n + dof]
    if other >= 0:
        x -= y[other]
        v -= y[n + other]
    return x, v


@inlined
def stop(laws, n, row, y):  # type: ignore[no-untyped-def]
    """Make the velocity of a law's dof that of what it sticks to."""
    dof, other = laws.numbers[row, PLACE], laws.numbers[row, OTHER]
    y[n + dof] = y[n + other] if other >= 0 else 0.0


@inlined
def first_mode(laws, row, x, v):  # type: ignore[no-untyped-def]
    """Mode of a law in which a motion begins; a dof without velocity sticks, and instants are to come."""
    partition, mode = laws.numbers[row, PARTITION], 0
    if partition == POSITION:
        for k in range(laws.thresholds.shape[1]):
            mode += 1 if x > laws.thresholds[row, k] else 0
    elif partition == VELOCITY:
        mode = -1 if v < 0.0 else 1
    elif partition == FRICTION:
        mode = 1 if v > 0.0 else -1 if v < 0.0 else 0
    return mode


@inlined
def keep_time(laws, t, modes):  # type: ignore[no-untyped-def]
    """Put laws whose modes meet at instants into those in force from time `t` (s) on; returns how long they
    stay, in s.
    """
    left = np.inf
    for row in range(laws.numbers.shape[0]):
        if laws.numbers[row, PARTITION] == TIME:
            modes[row] = 0
            for k in range(laws.thresholds.shape[1]):
                ahead = laws.thresholds[row, k] - t
                if ahead <= SAME_INSTANT:
                    modes[row] += 1
                else:
                    left = min(left, ahead)
    return left


@inlined
def room(thresholds, row, mode, x, upwards):  # type: ignore[no-untyped-def]
    """How far position `x` is from the threshold of its mode on one side; negative: beyond it."""
    left = np.inf
    if upwards and mode < 2:
        left = thresholds[row, mode] - x
    elif not upwards and mode > 0:
        left = x - thresholds[row, mode - 1]
    return left


@inlined
def guard(laws, n, row, mode, y, hold):  # type: ignore[no-untyped-def]
    """How far a law is from leaving its mode; negative: it has left it. `hold` is the force that holds the
    dof, in N, where it sticks.
    """
    partition, left = laws.numbers[row, PARTITION], np.inf
    x, v = motion_of(laws, n, row, y)
    if partition == POSITION:
        above = room(laws.thresholds, row, mode, x, True)
        left = min(above, room(laws.thresholds, row, mode, x, False))
    elif partition == FRICTION and mode == 0:
        left = laws.breakaway[row] - abs(hold)
    elif partition in (VELOCITY, FRICTION):
        left = mode * v
    return left


@inlined
def breakaway_mode(hold):  # type: ignore[no-untyped-def]
    """Mode of a friction that comes loose: the dof moves against the force that held it."""
    return -1 if hold > 0.0 else 1


@inlined
def next_mode(laws, n, row, mode, y, hold):  # type: ignore[no-untyped-def]
    """Mode that follows the present one, which has just been left; a dof that begins to stick is stopped."""
    partition, following = laws.numbers[row, PARTITION], -mode
    x, _ = motion_of(laws, n, row, y)
    if partition == POSITION:
        following = mode + 1 if mode < 2 and x >= laws.thresholds[row, mode] else mode - 1
    elif partition == FRICTION and mode == 0:
        following = breakaway_mode(hold)
    elif partition == FRICTION:
        stop(laws, n, row, y)
        following = 0
    return following


@inlined
def between(low, high, at_low, at_high):  # type: ignore[no-untyped-def]
    """Where a guard is looked at next; it is `at_low` (0: unknown) and `at_high` < 0 at the ends."""
    middle = (low * at_high - high * at_low) / (at_high - at_low) if at_low > 0.0 else 0.5 * (low + high)
    return middle if low < middle < high else 0.5 * (low + high)


@inlined
def narrowed(low, high, at_low, at_high, middle, value):  # type: ignore[no-untyped-def]
    """Interval and margins at its ends after `value` was found at `middle` (Illinois method)."""
    if value < 0.0:
        at_low = 0.5 * at_low if high - middle < 0.01 * (high - low) else at_low
        high, at_high = middle, value
    else:
        at_high = 0.5 * at_high if middle - low < 0.01 * (high - low) else at_high
        low, at_low = middle, value
    return low, high, at_low, at_high
