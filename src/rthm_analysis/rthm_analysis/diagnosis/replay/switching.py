"""Where laws leave their pieces within a step of a replay, compiled."""

from __future__ import annotations

from rthm_analysis.diagnosis.replay.compiled import inlined
from rthm_analysis.diagnosis.replay.rates import piece_of
from rthm_core.physical.laws import FRICTION, PLACE, POSITION, SPLIT


@inlined
def guards(n, laws, thresholds, pieces, row, y, end):  # type: ignore[no-untyped-def]
    """How far a law is from leaving its piece at the start and at the end of a step; negative: it has."""
    split, piece = laws[row, SPLIT], pieces[row]
    if split == FRICTION and piece != 0:
        return piece * y[n + laws[row, PLACE]], piece * end[n + laws[row, PLACE]]
    if split == POSITION:
        return _room(thresholds, row, piece, y[laws[row, PLACE]], end[laws[row, PLACE]])
    return 1.0, 1.0


@inlined
def first_switch(n, laws, thresholds, pieces, y, end):  # type: ignore[no-untyped-def]
    """Share of a step after which the first law leaves its piece, and that law; (1, -1): none does."""
    share, law = 1.0, -1
    for row in range(laws.shape[0]):
        before, after = guards(n, laws, thresholds, pieces, row, y, end)
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
def _room(thresholds, row, piece, x0, x1):  # type: ignore[no-untyped-def]
    """Distance to the threshold towards which a motion from x0 to x1 goes, at its start and its end."""
    if piece < 2 and x1 > x0:
        return thresholds[row, piece] - x0, thresholds[row, piece] - x1
    if piece > 0 and x1 < x0:
        return x0 - thresholds[row, piece - 1], x1 - thresholds[row, piece - 1]
    return 1.0, 1.0


@inlined
def switch(n, laws, pieces, y, row):  # type: ignore[no-untyped-def]
    """Put a law into its next piece; a dry friction sticks.

    Where a motion turns at a threshold, the velocity found there may point the other way; the law then stays
    in its outermost piece.
    """
    dof = laws[row, PLACE]
    if laws[row, SPLIT] == FRICTION:
        y[n + dof] = 0.0
        pieces[row] = 0
    else:
        pieces[row] = min(max(pieces[row] + (1 if y[n + dof] > 0.0 else -1), 0), 2)


@inlined
def break_away(laws, breakaway, pieces, hold):  # type: ignore[no-untyped-def]
    """Let go what is held by more than its breakaway force; whether anything was."""
    loose = False
    for row in range(laws.shape[0]):
        if laws[row, SPLIT] == FRICTION and pieces[row] == 0 and abs(hold[row]) > breakaway[row]:
            pieces[row] = -1 if hold[row] > 0.0 else 1
            loose = True
    return loose


@inlined
def first_pieces(n, laws, thresholds, y, pieces):  # type: ignore[no-untyped-def]
    """Put all laws into the pieces of a free run's first motion."""
    for row in range(laws.shape[0]):
        x, v = y[laws[row, PLACE]], y[n + laws[row, PLACE]]
        if laws[row, SPLIT] == FRICTION:
            pieces[row] = 1 if v > 0.0 else -1 if v < 0.0 else 0
        else:
            pieces[row] = piece_of(row, laws, thresholds, x, v)
