"""What nodes tell in words: their diagnostics, and what happens once in a test."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from rthm_core import events

MISSED = re.compile(r"(Td\d) missed deadlines")
COUNTED = re.compile(r"(tau\d) (late|lost)")
EVENTS_KEPT = 100
"""Events that are kept."""


class Told:
    """Counts of clocks and links, and events, as they were told last.

    Attributes
    ----------
    abort : Abort or None
        The first one.
    rested : bool
        Whether the motors are where they stay after it.
    """

    def __init__(self) -> None:
        self.abort: events.Abort | None = None
        self.rested = False
        self.events: list[dict[str, Any]] = []
        self._clocks: dict[str, int] = {}
        self._links: dict[str, dict[str, int]] = {}
        self._priorities: dict[str, int] = {}

    def note_event(self, text: str) -> None:
        """Take a message of the topic ``events``; one that was told twice is told once."""
        event = events.read_event(text)
        abort = events.abort_of(event)
        if abort is not None and self.abort is not None:
            return
        self.abort = abort or self.abort
        self.rested = self.rested or event.get("event") == events.REST
        if event and len(self.events) < EVENTS_KEPT:
            at = event.get("at")
            self.events.append({"at": at if isinstance(at, int | float) else None, "words": _words(event)})

    def note_status(self, name: str, values: Mapping[str, str]) -> None:
        """Take a status of ``/diagnostics``: of a node's loop it has the counts."""
        node, _, part = name.rpartition(": ")
        if part != "loop":
            return
        for key, value in values.items():
            if not value.isdecimal():
                continue
            if missed := MISSED.fullmatch(key):
                self._clocks[missed[1]] = int(value)
            elif counted := COUNTED.fullmatch(key):
                self._links.setdefault(counted[1], {})[counted[2]] = int(value)
            elif key == "real-time priority":
                self._priorities[node.rpartition("/")[2]] = int(value)

    @property
    def clocks(self) -> list[dict[str, Any]]:
        """Missed ticks of every clock."""
        return [{"name": name, "missed": count} for name, count in sorted(self._clocks.items())]

    @property
    def without_priority(self) -> list[str]:
        """Nodes of the loop that run without real-time priority."""
        return sorted(node for node, priority in self._priorities.items() if not priority)

    def counts_of(self, link: str) -> dict[str, int | None]:
        """Samples of a link that came late, and that never came; None: not told yet."""
        return {"late": None, "lost": None} | self._links.get(link, {})


def _words(event: Mapping[str, Any]) -> str:
    kind = str(event["event"])
    abort = events.abort_of(event)
    if abort is not None:
        return f"Aborted: {abort.words}"
    if kind == events.ARMED:
        motors = event.get("motor") or []
        return f"Armed: the motors stand at {', '.join(f'{motor:.4g}' for motor in motors)} m."
    if kind == events.REST:
        return "The motors are at rest."
    return f"{kind}: {event.get('words') or ''}".rstrip(": ")
