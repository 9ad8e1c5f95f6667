"""The processes of a run: started together, ended together, whatever happens to the launcher."""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

PATIENCE = ((signal.SIGTERM, 5.0), (signal.SIGKILL, 2.0))  # how a process is asked to end, s
_PR_SET_PDEATHSIG = 1
JOINT = "+"
"""Stands between the names of nodes that share a process."""


@dataclass
class Process:
    """One process of a run; what it says goes to its log.

    Parameters
    ----------
    name
        Name of its node; of several, joined by ``+``.
    command
        Program and arguments.
    log
        File for standard output and error.
    """

    name: str
    command: Sequence[str]
    log: Path
    _child: subprocess.Popen[bytes] | None = None

    def start(self, environment: Mapping[str, str]) -> None:
        """Start it in a session of its own, so that Ctrl-C reaches the launcher alone."""
        with self.log.open("wb") as output:
            self._child = subprocess.Popen(
                self.command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=dict(environment),
                start_new_session=True,
                preexec_fn=_end_with_parent(),
            )

    @property
    def nodes(self) -> frozenset[str]:
        """Names of its nodes."""
        return frozenset(self.name.split(JOINT))

    @property
    def pid(self) -> int:
        """Process id."""
        assert self._child is not None
        return self._child.pid

    @property
    def alive(self) -> bool:
        """Whether it runs."""
        return self._child is not None and self._child.poll() is None

    def send(self, number: signal.Signals) -> None:
        """Send a signal, if it runs."""
        if self._child is not None and self.alive:
            self._child.send_signal(number)

    def fate(self) -> str:
        """How it ended, in words, with the last thing that it said."""
        assert self._child is not None
        status = self._child.returncode
        way = f"was killed by {signal.Signals(-status).name}" if status < 0 else f"ended with status {status}"
        last = self.last_words() or _no_space(self.log.parent)
        return f"{self.name} {way}" + (f": {last}" if last else f" (log: {self.log})")

    def last_words(self) -> str:
        """Last line of its log that is not empty."""
        lines = self.log.read_text(errors="replace").splitlines()
        return next((line.strip() for line in reversed(lines) if line.strip()), "")

    def realtime(self) -> bool:
        """Whether one of its threads has real-time priority."""
        threads = Path(f"/proc/{self.pid}/task")
        return any(_is_realtime(int(thread.name)) for thread in threads.iterdir())


class Processes:
    """All processes of a run, in the order of their start; leaving the ``with`` block ends them."""

    def __init__(self) -> None:
        self._all: list[Process] = []

    def __enter__(self) -> Processes:
        return self

    def __exit__(self, *error: object) -> None:
        self.stop()

    def start(self, process: Process, environment: Mapping[str, str]) -> None:
        """Start one more."""
        process.start(environment)
        self._all.append(process)

    def dead(self) -> list[Process]:
        """Those that ended."""
        return [process for process in self._all if not process.alive]

    def living(self) -> list[Process]:
        """Those that run."""
        return [process for process in self._all if process.alive]

    def stop(self) -> None:
        """End all of them: ask first, insist, then kill."""
        for number, seconds in PATIENCE:
            for process in self.living():
                process.send(number)
            deadline = time.monotonic() + seconds
            while self.living() and time.monotonic() < deadline:
                time.sleep(0.01)


def _end_with_parent() -> Callable[[], None]:
    """Make a function for the child that ties its life to the launcher's, even if that is killed.

    The signal is one that a node obeys in good order: a recorder closes its bag.
    """
    library = ctypes.CDLL(None)
    parent = os.getpid()

    def tie() -> None:
        library.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
        if os.getppid() != parent:
            os._exit(1)

    return tie


def _no_space(folder: Path) -> str:
    """Words about a disk that is full, where a log could say nothing for that."""
    return f"no space is left in {folder}" if shutil.disk_usage(folder).free == 0 else ""


def _is_realtime(thread: int) -> bool:
    try:
        return os.sched_getscheduler(thread) in (os.SCHED_FIFO, os.SCHED_RR)
    except ProcessLookupError:
        return False
