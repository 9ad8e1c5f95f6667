"""Work on all cores at once, in threads: replays do not hold the interpreter's lock."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from typing import TypeVar

from rthm_analysis.diagnosis.criteria.fitting import MOST_THREADS

A = TypeVar("A")
B = TypeVar("B")


class Cores:
    """Two layers of threads, so that work which waits for other work does not keep it from being done."""

    def __init__(self) -> None:
        count = max(1, min(os.cpu_count() or 1, MOST_THREADS))
        self._threads = ThreadPoolExecutor(count)
        self._waiting = ThreadPoolExecutor(count)

    def each(self, work: Callable[[A], B], items: Iterable[A]) -> list[B]:
        """Do some work for all items; it must not call `each` itself."""
        return _each(self._threads, work, items)

    def each_in_parts(self, work: Callable[[A], B], items: Iterable[A]) -> list[B]:
        """Do some work for all items that may call `each` for its parts."""
        return _each(self._waiting, work, items)


def _each(threads: ThreadPoolExecutor, work: Callable[[A], B], items: Iterable[A]) -> list[B]:
    """Results in the order of the items; what numpy is told to be silent about holds in the threads too."""
    running = [threads.submit(copy_context().run, work, item) for item in items]
    return [one.result() for one in running]
