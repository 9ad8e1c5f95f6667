"""What happens once in a test, published to everybody on the topic ``events``: JSON in a ``std_msgs/String``.

    {"event": "armed", "at": 0.0, "motor": [0.1], ...}    the rig was compared with the spec
    {"event": "abort", "at": 3.008, "limit": "step", "value": 0.3, "allowed": 0.012, "words": "..."}
    {"event": "rest", "at": 3.508}                        the way back after an abort is over

Any node may tell an abort; the controller obeys the first one, whoever tells it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

ABORT, ARMED, REST = "abort", "armed", "rest"
"""Kinds of event."""


@dataclass(frozen=True)
class Abort:
    """Why a test was ended.

    Attributes
    ----------
    at
        When, s after the start of the test.
    limit
        Name of the limit that was broken: an entry of the spec's ``limits``, or ``finite``, ``owner``,
        ``operator``, ``node``.
    value, allowed
        What was measured and what is allowed, in the limit's unit; None where there is no figure.
    words
        What happened, as the end of "Aborted at 3.008 s: ...".
    """

    at: float
    limit: str
    value: float | None
    allowed: float | None
    words: str

    @property
    def sentence(self) -> str:
        """First line of everything that tells of this test."""
        return f"Aborted at {self.at:.3f} s: {self.words}"

    def as_dict(self) -> dict[str, Any]:
        """Entry ``abort`` of the JSON of ``rthm run``; what is not finite is None."""
        return {key: _plain(value) for key, value in asdict(self).items()}


def write_event(kind: str, **values: Any) -> str:
    """Text of an event."""
    return json.dumps({"event": kind} | {key: _plain(value) for key, value in values.items()})


def write_abort(abort: Abort) -> str:
    """Text of the event that ends a test."""
    return write_event(ABORT, **abort.as_dict())


def read_event(text: str) -> dict[str, Any]:
    """Event of a text; empty when it is none."""
    try:
        event = json.loads(text)
    except ValueError:
        return {}
    return event if isinstance(event, dict) and isinstance(event.get("event"), str) else {}


def abort_of(event: Mapping[str, Any]) -> Abort | None:
    """Return the abort that an event tells of, None if it tells of none.

    An abort with figures that cannot be read is an abort.
    """
    if event.get("event") != ABORT:
        return None
    at, value, allowed = (_number(event.get(key)) for key in ("at", "value", "allowed"))
    words = str(event.get("words") or "without a word")
    return Abort(at or 0.0, str(event.get("limit") or "unknown"), value, allowed, words)


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None


def _plain(value: Any) -> Any:
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
