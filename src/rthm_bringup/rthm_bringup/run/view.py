"""What a run shows while it goes on: a bar on standard error, if that is a terminal."""

from __future__ import annotations

import sys
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn


class View:
    """Phase and progress of a run; nothing is shown where nobody looks."""

    def __init__(self) -> None:
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[note]}"),
            TimeRemainingColumn(),
            console=Console(stderr=True),
            transient=True,
            disable=not sys.stderr.isatty(),
        )
        self._task = self._progress.add_task("", total=None, note="")

    def __enter__(self) -> View:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def phase(self, words: str) -> None:
        """Say what goes on now."""
        self._progress.update(self._task, description=words, total=None, completed=0, note="")

    def progress(self, done: float, total: float) -> None:
        """Say how many seconds of the test are over; `total` 0: no end is known."""
        note = f"{done:.0f} of {total:g} s" if total else f"{done:.0f} s, Ctrl-C ends it"
        self._progress.update(self._task, completed=done, total=total or None, note=note)

    def note(self, words: str) -> None:
        """Say something that stays, also where nobody watches."""
        self._progress.console.print(words, highlight=False, soft_wrap=True)
