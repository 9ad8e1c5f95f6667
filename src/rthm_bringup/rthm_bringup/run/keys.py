"""Keys that are pressed in the terminal of a run, without Enter."""

from __future__ import annotations

import os
import select
import sys
import termios
import tty
from types import TracebackType
from typing import Any

ABORT = "a"
"""Key that ends the test as an abort."""


class Keys:
    """Keys since the last look; none where no terminal is, or where it belongs to another program.

    Parameters
    ----------
    descriptor
        Of the terminal; None: standard input.
    """

    def __init__(self, descriptor: int | None = None) -> None:
        self._descriptor = descriptor
        self._before: list[Any] | None = None

    def __enter__(self) -> Keys:
        if self._descriptor is None and sys.stdin is not None and sys.stdin.isatty():
            self._descriptor = sys.stdin.fileno()
        if self._descriptor is not None and self._is_ours():
            self._before = termios.tcgetattr(self._descriptor)
            tty.setcbreak(self._descriptor)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._descriptor is not None and self._before is not None:
            termios.tcsetattr(self._descriptor, termios.TCSADRAIN, self._before)

    @property
    def watched(self) -> bool:
        """Whether keys are seen."""
        return self._before is not None

    def pressed(self) -> str:
        """Keys since the last look, in order."""
        if self._descriptor is None or not self.watched:
            return ""
        if not self._is_ours() or not select.select([self._descriptor], [], [], 0.0)[0]:
            return ""
        return os.read(self._descriptor, 64).decode(errors="replace")

    def _is_ours(self) -> bool:
        """Whether reading would not stop this process, as it does one in the background."""
        assert self._descriptor is not None
        try:
            return os.tcgetpgrp(self._descriptor) == os.getpgrp()
        except OSError:
            return True  # not the terminal that controls this process
