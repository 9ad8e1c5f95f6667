"""What the leader itself watches while a test runs, and how it ends the test when a limit is broken."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from rthm_core.owner import LIMIT as OWNER
from rthm_core.owner import second_owner

EVERY = 0.1
"""Time between two looks at the graph, s."""


class Broken(NamedTuple):
    """A limit that is broken, in the words of the contract's ``abort``.

    Attributes
    ----------
    limit
        Its name.
    value, allowed
        What was found, and the most that is allowed.
    words
        What happened, in one sentence.
    """

    limit: str
    value: float
    allowed: float
    words: str


class OwnerWatch:
    """Looks whether each topic of the loop has one publisher.

    Parameters
    ----------
    publishers
        Full names of the nodes that publish each topic that has more than one publisher.
    now
        Time, s.
    """

    def __init__(
        self,
        publishers: Callable[[], Mapping[str, Sequence[str]]],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._publishers, self._now, self._next = publishers, now, 0.0

    def broken(self) -> Broken | None:
        """Return the limit that a second publisher broke; looks at most once in `EVERY`."""
        if self._now() < self._next:
            return None
        self._next = self._now() + EVERY
        found = self._publishers()
        words = second_owner(found)
        return Broken(OWNER, max(map(len, found.values())), 1, f"{words}.") if words else None
