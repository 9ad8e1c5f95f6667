"""Signals that ask a program to end, obeyed as Ctrl-C is."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupted_by(*signals: signal.Signals) -> Iterator[None]:
    """Let each of these signals raise KeyboardInterrupt; afterwards they do what they did before.

    SIGINT is among them where the background job of a shell, which ignores it, is to obey as well.
    """
    before = {number: signal.signal(number, signal.default_int_handler) for number in signals}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
