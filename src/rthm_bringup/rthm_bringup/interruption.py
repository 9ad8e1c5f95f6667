"""Signals that ask a program to end, obeyed as Ctrl-C is."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Handler = Callable[[int, Any], Any]


@contextmanager
def interrupted_by(*signals: signal.Signals) -> Iterator[None]:
    """Let each of these signals raise KeyboardInterrupt; afterwards they do what they did before.

    SIGINT is among them where the background job of a shell, which ignores it, is to obey as well.
    """
    with _handled(signal.default_int_handler, signals):
        yield


class Interruption:
    """What asks a program to end, and waits until that may be."""

    def __init__(self) -> None:
        self._asked = False

    def note(self, number: int, frame: Any) -> None:
        """Take a signal."""
        self._asked = True

    def obey(self) -> None:
        """Raise KeyboardInterrupt if it was asked for."""
        if self._asked:
            self._asked = False
            raise KeyboardInterrupt


@contextmanager
def held_back() -> Iterator[Interruption]:
    """Have SIGINT and SIGTERM wait until they are obeyed (`Interruption.obey`), or for the end of the block.

    Calls of ROS cannot be left anywhere: one that is broken off loses what it was about to take, as the
    answer of a node, or raises an error of its own.
    """
    interruption = Interruption()
    with _handled(interruption.note, (signal.SIGINT, signal.SIGTERM)):
        yield interruption
    interruption.obey()


@contextmanager
def _handled(handler: Handler, signals: tuple[signal.Signals, ...]) -> Iterator[None]:
    """Let a handler take signals; afterwards they do what they did before."""
    before = {number: signal.signal(number, handler) for number in signals}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)
