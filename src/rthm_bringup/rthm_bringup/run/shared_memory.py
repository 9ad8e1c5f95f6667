"""Shared memory that killed processes of a run leave behind, and the caretaker that removes it.

The middleware keeps messages between the processes of a host in files under ``/dev/shm``. A process that
ends removes its own; one that is killed cannot. A living owner holds a lock on the file whose name ends in
``_el`` or ``_sl``, so what is left is told from what is in use.
"""

from __future__ import annotations

import fcntl
import os
import signal
import time
from pathlib import Path

FOLDER = Path("/dev/shm")
PREFIXES = ("fastrtps_", "fast_datasharing_", "sem.fastrtps_", "lttng-ust-wait")
PROCESSES_END_WITHIN = 15.0
"""How long the processes of a killed launcher may take to end, s."""


def files() -> set[str]:
    """Names of the files of ROS processes there now."""
    if not FOLDER.is_dir():
        return set()
    return {path.name for path in FOLDER.iterdir() if path.name.startswith(PREFIXES)}


def abandoned() -> set[str]:
    """Names of those without a living owner."""
    return {name for name in files() if not _owned(name)}


def clean_up(before: set[str]) -> None:
    """Remove what came after `before` and has no living owner."""
    for name in abandoned() - before:
        (FOLDER / name).unlink(missing_ok=True)


class Caretaker:
    """A process that outlives this one, and then removes what was left in shared memory since its own start.

    It is made before ROS is imported, by a fork, and used in a ``with`` block. When this process is killed,
    its nodes are told to end, and the caretaker goes when they are gone.
    """

    def __enter__(self) -> Caretaker:
        before = files()
        end, self._leash = os.pipe()
        self._child = os.fork()
        if self._child == 0:
            os.close(self._leash)
            _take_care(end, before)
        os.close(end)
        return self

    def __exit__(self, *error: object) -> None:
        os.write(self._leash, b"orderly")
        os.close(self._leash)
        os.waitpid(self._child, 0)


def _take_care(leash: int, before: set[str]) -> None:
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    orderly = bool(os.read(leash, 16))
    deadline = time.monotonic() + PROCESSES_END_WITHIN
    clean_up(before)
    while not orderly and files() - before and time.monotonic() < deadline:
        time.sleep(0.2)
        clean_up(before)
    os._exit(0)


def _owned(name: str) -> bool:
    base = name.removeprefix("sem.").removesuffix("_mutex").removesuffix("_el").removesuffix("_sl")
    return any(_locked(FOLDER / (base + suffix)) for suffix in ("_el", "_sl"))


def _locked(path: Path) -> bool:
    try:
        with path.open("rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return False
