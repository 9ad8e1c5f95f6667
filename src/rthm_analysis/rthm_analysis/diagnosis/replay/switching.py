"""Where laws leave their modes within a step of a replay, compiled: nearly, where the simulator is exact."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.replay.compiled import inlined
from rthm_core.physical.laws import FRICTION, PARTITION, POSITION, VELOCITY
from rthm_core.physical.switching import between, first_mode, guard, motion_of, next_mode, room


@inlined
def follow(laws, n, y, modes, everywhere):  # type: ignore[no-untyped-def]
    """Put laws into the modes of the present motion: all of them where a free run begins, else those whose
    modes meet in a velocity. Nothing jumps there, so that no step has to end there.
    """
    for row in range(laws.numbers.shape[0]):
        if everywhere or laws.numbers[row, PARTITION] == VELOCITY:
            x, v = motion_of(laws, n, row, y)
            modes[row] = first_mode(laws, row, x, v)


@inlined
def margins(laws, n, modes, row, y, end, held, hold):  # type: ignore[no-untyped-def]
    """How far a law is from leaving its mode, towards where it is going, at the start and at the end of a
    step; negative: it has left it. `held` and `hold` are the forces that hold sticking dofs there.
    """
    mode, partition = modes[row], laws.numbers[row, PARTITION]
    before, after = np.inf, np.inf
    x, _ = motion_of(laws, n, row, y)
    x_end, _ = motion_of(laws, n, row, end)
    if partition == FRICTION:
        before, after = guard(laws, n, row, mode, y, held[row]), guard(laws, n, row, mode, end, hold[row])
    elif partition == POSITION and x != x_end:
        upwards = x_end > x
        before = room(laws.thresholds, row, mode, x, upwards)
        after = room(laws.thresholds, row, mode, x_end, upwards)
    return before, after


@inlined
def first_switch(laws, n, modes, y, end, held, hold):  # type: ignore[no-untyped-def]
    """Share of a step after which the first law leaves its mode, and that law; (1, -1): none does."""
    share, law = 1.0, -1
    for row in range(laws.numbers.shape[0]):
        before, after = margins(laws, n, modes, row, y, end, held, hold)
        if after < 0.0:
            at = before / (before - after) if before > 0.0 else 0.0
            if at < share:
                share, law = at, row
    return share, law


@inlined
def sharpened(share, before, here, after):  # type: ignore[no-untyped-def]
    """Share of a step at which a margin vanishes, from its values at the start, at `share` and at the end."""
    if here == 0.0:
        return share
    return between(share, 1.0, here, after) if here > 0.0 else between(0.0, share, before, here)


@inlined
def switch(laws, n, modes, y, row, hold):  # type: ignore[no-untyped-def]
    """Put a law into its next mode; a dry friction sticks, or comes loose from the force that held it.

    The place of a threshold was found nearly, so that the velocity tells to which side the motion goes;
    where it turns there, the law stays in its outermost mode.
    """
    mode = modes[row]
    if laws.numbers[row, PARTITION] == FRICTION:
        modes[row] = next_mode(laws, n, row, mode, y, hold[row])
    else:
        _, v = motion_of(laws, n, row, y)
        modes[row] = min(max(mode + (1 if v > 0.0 else -1), 0), laws.thresholds.shape[1])
