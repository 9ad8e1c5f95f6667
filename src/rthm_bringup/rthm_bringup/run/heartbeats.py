"""Which nodes have fallen silent, as somebody sees it whose own host may stall."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

LONGEST_LOOK = 0.05
"""Longest time between two looks that counts as silence of others, s; the rest was the listener's own."""
DEAF = 1.0
"""Time between two looks that a busy host explains, s; where `limit` is longer, that."""


class Silence(NamedTuple):
    """A node that has not been heard for so long, s."""

    name: str
    seconds: float


class Heartbeats:
    """Beats of some nodes; each counts from its first one.

    Parameters
    ----------
    names
        Nodes that have to go on.
    limit
        Longest silence, s.

    Attributes
    ----------
    deaf
        How long the listener stalled before this look, s; 0: for no longer than can be put up with.
    """

    def __init__(self, names: Iterable[str], limit: float) -> None:
        self.deaf = 0.0
        self._names, self.limit = frozenset(names), limit
        self._silent: dict[str, float] = {}
        self._beaten: set[str] = set()
        self._looked: float | None = None

    def beat(self, name: str) -> None:
        """Note that a node was heard."""
        if name in self._names:
            self._beaten.add(name)

    def look(self, now: float) -> Silence | None:
        """Return a node that has been silent for too long at `now`, s; None if none has."""
        between = 0.0 if self._looked is None else now - self._looked
        self._looked, passed = now, min(between, LONGEST_LOOK)
        self.deaf = between if between > max(self.limit, DEAF) else 0.0
        beaten, self._beaten = self._beaten, set()
        self._silent |= dict.fromkeys(beaten, 0.0)
        for name in self._silent.keys() - beaten:
            self._silent[name] += passed
            if self._silent[name] > self.limit:
                return Silence(name, self._silent[name])
        return None
