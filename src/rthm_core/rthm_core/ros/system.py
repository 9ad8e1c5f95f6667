"""What a process asks of the operating system for the loop, and what it got.

Nothing here fails: where the system refuses, the loop runs with what there is, and the refusal is reported.
"""

from __future__ import annotations

import ctypes
import gc
import os
from typing import NamedTuple

MCL_CURRENT, MCL_FUTURE, MCL_ONFAULT = 1, 2, 4
PR_SET_TIMERSLACK = 29


class Granted(NamedTuple):
    """What the operating system granted.

    Attributes
    ----------
    priority
        SCHED_FIFO priority of every thread; 0: normal scheduling.
    locked
        Whether all memory stays in RAM.
    """

    priority: int
    locked: bool


def prepare(priority: int, lock_memory: bool) -> Granted:
    """Make this process as punctual as it may be.

    Parameters
    ----------
    priority
        SCHED_FIFO priority 1 to 99 that is wanted for all threads of the process, those of the middleware
        included; 0: keep normal scheduling.
    lock_memory
        Keep all memory in RAM, so that no page has to be fetched in the middle of a period.
    """
    _library().prctl(PR_SET_TIMERSLACK, ctypes.c_ulong(1), 0, 0, 0)  # else every sleep may last 50 us longer
    locked = lock_memory and _library().mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0
    return Granted(priority if priority and _schedule(os.SCHED_FIFO, priority) else 0, locked)


def prepare_virtual() -> Granted:
    """Make this process work in long stretches, as simulated time waits for nobody.

    By default a thread that gets a message interrupts the one that sent it, for every message; this way the
    sender goes on and the receiver finds many.
    """
    _schedule(os.SCHED_BATCH, 0)
    return Granted(0, False)


def as_usual() -> None:
    """Give real-time priority back, as what comes next has no deadline."""
    if os.sched_getscheduler(0) == os.SCHED_FIFO:
        _schedule(os.SCHED_OTHER, 0)


def hold_garbage() -> None:
    """Collect now and no more: a full collection takes longer than a period."""
    gc.collect()
    gc.freeze()
    gc.disable()


def release_garbage() -> None:
    """Collect again as usual."""
    gc.enable()
    gc.unfreeze()


def _schedule(policy: int, priority: int) -> bool:
    """Change how all threads of this process are scheduled; return whether that is allowed."""
    for thread in os.listdir("/proc/self/task"):
        try:
            os.sched_setscheduler(int(thread), policy, os.sched_param(priority))
        except ProcessLookupError:
            continue
        except OSError:
            return False
    return True


def _library() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)
