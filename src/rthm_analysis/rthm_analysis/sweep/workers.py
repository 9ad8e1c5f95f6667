"""Who runs the batches: this process, processes of this machine, or a Dask cluster. All are executors."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from rthm_core.errors import InputError

CONNECT_S = 10.0
"""How long a scheduler may take to answer."""


@dataclass(frozen=True)
class Workers:
    """An executor, how many batches it runs at once, and whether it is still there."""

    executor: Executor
    count: int
    there: Callable[[], bool] = lambda: True


class _ThisProcess(Executor):
    """Runs what is submitted at once."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        done: Future[Any] = Future()
        done.set_result(fn(*args, **kwargs))
        return done


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))


@contextmanager
def local_workers(count: int) -> Iterator[Workers]:
    """Processes of this machine; one worker is this process itself."""
    if count == 1:
        yield Workers(_ThisProcess(), 1)
        return
    fresh = multiprocessing.get_context("spawn")  # threads and compiled code do not survive a fork
    pool = ProcessPoolExecutor(count, fresh, initializer=_leave_interrupts_to_the_parent)
    try:
        yield Workers(pool, count)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _leave_interrupts_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


@contextmanager
def cluster_workers(address: str) -> Iterator[Workers]:
    """Workers of a Dask scheduler, which must have this package installed.

    Raises
    ------
    InputError
        When distributed is not installed, or no scheduler with workers answers at the address.
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "a Dask cluster needs the packages dask and distributed, which are not installed; install the "
            "dependency group cluster, or leave --scheduler out to use this machine."
        ) from None
    try:
        client = Client(address, timeout=CONNECT_S, name="rthm sweep")
    except (OSError, ValueError, TypeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(
            f"no Dask scheduler answers at {address!r} ({reason}); start one, or correct the address."
        ) from None
    with client:
        threads = sum(
            worker["nthreads"] for worker in client.scheduler_info(n_workers=-1)["workers"].values()
        )
        if threads == 0:
            raise InputError(f"the Dask scheduler at {address!r} has no workers; start some and try again.")
        yield Workers(client.get_executor(pure=False), threads, lambda: client.status == "running")
