"""A listener's part in a run in simulated time: time waits until it holds what was sent."""

from __future__ import annotations

from rthm_core.ros.agenda import NEVER, Position
from rthm_core.ros.grants import PARTS, SOURCES, Done, Grant


class Attendance:
    """Counts messages and answers grants; it sends none itself.

    Parameters
    ----------
    part
        Name of the listener in `PARTS`.
    """

    def __init__(self, part: str) -> None:
        self._part = PARTS.index(part)
        self._held = dict.fromkeys(SOURCES, 0)
        self._open: Grant | None = None

    def greeting(self) -> bytes:
        """Message that says that the listener is there."""
        return self._done(0)

    def hear(self, topic: str) -> bytes | None:
        """Count a message; return the answer that it makes possible."""
        if topic not in self._held:
            return None
        self._held[topic] += 1
        return self._answer()

    def receive(self, grant: bytes) -> bytes | None:
        """Take a grant; return the answer if everything is there already."""
        self._open = Grant.read(grant)
        return self._answer()

    def complete(self) -> bool:
        """Whether everything is there that was sent before the newest grant."""
        return self._open is None

    def _answer(self) -> bytes | None:
        if self._open is None or any(
            self._held[source] < count for source, count in zip(SOURCES, self._open.messages, strict=True)
        ):
            return None
        round_, self._open = self._open.round, None
        return self._done(round_)

    def _done(self, round_: int) -> bytes:
        return Done(self._part, round_, Position(NEVER, 0), (0,) * len(SOURCES)).message()
