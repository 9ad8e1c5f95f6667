"""How long this machine keeps a thread from running while something else is measured."""

from __future__ import annotations

import os
import threading
import time
from contextlib import suppress
from types import TracebackType

NAP = 0.005
"""Time between two looks, s."""


class Stalls:
    """Watches, with real-time priority where the system grants it, how late a thread wakes up.

    Parameters
    ----------
    priority
        That of the thread.
    """

    def __init__(self, priority: int = 90) -> None:
        self._priority = priority
        self._waits = [(time.time_ns(), 0)]
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Stalls:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._thread.join()

    def within(self, begin: int, end: int, least: float = 0.0) -> float:
        """How long it was held up from `begin` to `end` (ns of the wall clock), s.

        Parameters
        ----------
        least
            Shortest wait that counts, s.
        """
        waits = (wait for at, wait in self._waits.copy() if begin < at + wait and at < end)
        return sum(wait for wait in waits if wait >= least * 1e9) / 1e9

    def last(self, seconds: float) -> float:
        """How long it was held up in the last so many seconds, s."""
        now = time.time_ns()
        return self.within(now - int(seconds * 1e9), now)

    def _watch(self) -> None:
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(self._priority))
        while not self._over.is_set():
            due = time.time_ns() + int(NAP * 1e9)
            time.sleep(NAP)
            self._waits.append((due, time.time_ns() - due))
