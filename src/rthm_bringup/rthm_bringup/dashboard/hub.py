"""Where the thread that watches a test meets those that serve its page."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rthm_analysis.dashboard import RunningTest

WAITING = {"state": "waiting", "words": "No test is running; the page will show the next one."}
TOLD_AGAIN_AFTER = 5.0
"""After how long a page is told the same again, so that one that has gone is noticed, s."""


class Hub:
    """What is shown now.

    Attributes
    ----------
    shown : dict
        The newest snapshot.
    abort : callable or None
        Asks for an abort of the test that is shown; None: there is no test, or nobody to ask.
    changing : threading.Condition
        Held by whoever changes what is shown.
    """

    def __init__(self) -> None:
        self.shown: Mapping[str, Any] = WAITING
        self.abort: Callable[[], None] | None = None
        self.changing = threading.Condition()
        self._number, self._closed = 0, False
        self._test: RunningTest | None = None

    def look(self, test: RunningTest | None, beside: Mapping[str, Any]) -> None:
        """Show what a test has come to, with what is known beside it; None: there is no test."""
        with self.changing:
            self._test = test
            can_abort = {"can_abort": self.abort is not None}
            self.shown = {**(test.look() if test else WAITING), **can_abort, **beside}
            self._number += 1
            self.changing.notify_all()

    def close(self) -> None:
        """Let all pages go."""
        with self.changing:
            self._closed = True
            self.changing.notify_all()

    def follow(self) -> Iterator[tuple[str, str]]:
        """Yield events for a page, name and JSON: ``layout`` of a test that is new to it, and ``now``.

        Ends when the hub is closed.
        """
        number, test, counts = -1, None, [0, 0]
        while not self._closed:
            with self.changing:
                if self._number == number:
                    self.changing.wait(TOLD_AGAIN_AFTER)
                number, new, shown = self._number, self._test is not test, self.shown
                test, counts = self._test, [0, 0] if new else counts
                layout = test.layout() if test and new else None
                traces = (test.motion, test.energy) if test else ()
                rows = [trace.after(count) for trace, count in zip(traces, counts, strict=False)]
                counts = [trace.count for trace in traces] or counts
            if layout is not None:
                yield "layout", _text(layout)
            yield "now", _text({**shown, "rows": rows or [[], []]})


def _text(value: Mapping[str, Any]) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False, separators=(",", ":"))
