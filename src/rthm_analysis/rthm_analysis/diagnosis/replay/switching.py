"""Where laws leave their modes within a step of a replay, compiled."""

from __future__ import annotations

from rthm_analysis.diagnosis.replay.compiled import inlined
from rthm_analysis.diagnosis.replay.rates import mode_of
from rthm_core.physical.laws import FRICTION, PARTITION, PLACE, POSITION


@inlined
def guards(n, laws, thresholds, modes, row, y, end):  # type: ignore[no-untyped-def]
    """How far a law is from leaving its mode at the start and at the end of a step; negative: it has."""
    partition, mode = laws[row, PARTITION], modes[row]
    if partition == FRICTION and mode != 0:
        return mode * y[n + laws[row, PLACE]], mode * end[n + laws[row, PLACE]]
    if partition == POSITION:
        return _room(thresholds, row, mode, y[laws[row, PLACE]], end[laws[row, PLACE]])
    return 1.0, 1.0


@inlined
def first_switch(n, laws, thresholds, modes, y, end):  # type: ignore[no-untyped-def]
    """Share of a step after which the first law leaves its mode, and that law; (1, -1): none does."""
    share, law = 1.0, -1
    for row in range(laws.shape[0]):
        before, after = guards(n, laws, thresholds, modes, row, y, end)
        if after < 0.0:
            at = before / (before - after) if before > 0.0 else 0.0
            if at < share:
                share, law = at, row
    return share, law


@inlined
def sharpened(share, before, here, after):  # type: ignore[no-untyped-def]
    """Share of a step at which a margin vanishes, from its values at the start, at `share` and at the end."""
    if here > 0.0 and here > after:
        return share + (1.0 - share) * here / (here - after)
    return share * before / (before - here) if before > here else share


@inlined
def _room(thresholds, row, mode, x0, x1):  # type: ignore[no-untyped-def]
    """Distance to the threshold towards which a motion from x0 to x1 goes, at its start and its end."""
    if mode < 2 and x1 > x0:
        return thresholds[row, mode] - x0, thresholds[row, mode] - x1
    if mode > 0 and x1 < x0:
        return x0 - thresholds[row, mode - 1], x1 - thresholds[row, mode - 1]
    return 1.0, 1.0


@inlined
def switch(n, laws, modes, y, row):  # type: ignore[no-untyped-def]
    """Put a law into its next mode; a dry friction sticks.

    Where a motion turns at a threshold, the velocity found there may point the other way; the law then stays
    in its outermost mode.
    """
    dof = laws[row, PLACE]
    if laws[row, PARTITION] == FRICTION:
        y[n + dof] = 0.0
        modes[row] = 0
    else:
        modes[row] = min(max(modes[row] + (1 if y[n + dof] > 0.0 else -1), 0), 2)


@inlined
def break_away(laws, breakaway, modes, hold):  # type: ignore[no-untyped-def]
    """Let go what is held by more than its breakaway force; whether anything was."""
    loose = False
    for row in range(laws.shape[0]):
        if laws[row, PARTITION] == FRICTION and modes[row] == 0 and abs(hold[row]) > breakaway[row]:
            modes[row] = -1 if hold[row] > 0.0 else 1
            loose = True
    return loose


@inlined
def first_modes(n, laws, thresholds, y, modes):  # type: ignore[no-untyped-def]
    """Put all laws into the modes of a free run's first motion."""
    for row in range(laws.shape[0]):
        x, v = y[laws[row, PLACE]], y[n + laws[row, PLACE]]
        if laws[row, PARTITION] == FRICTION:
            modes[row] = 1 if v > 0.0 else -1 if v < 0.0 else 0
        else:
            modes[row] = mode_of(row, laws, thresholds, x, v)
