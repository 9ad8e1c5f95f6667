"""Many loops on many workers, in batches that take about half a second each."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.sweep.batch import Batch, Order, run_batch
from rthm_analysis.sweep.folder import Folder
from rthm_analysis.sweep.points import sharing_order
from rthm_analysis.sweep.workers import Workers
from rthm_core.compiled import Floats, Integers
from rthm_core.errors import InputError

if TYPE_CHECKING:
    import pyarrow

BATCH_S = 0.5
"""How long a batch should take: long enough that sending it costs nothing, short enough to lose."""

GROWTH = 4
"""A batch is at most this many times larger than the last: a first loop says little about the others."""

LARGEST_BATCH = 5000

BATCHES_AHEAD = 2
"""Batches under way for every worker, so that none waits."""

LOOK_S = 2.0
"""How often it is checked that the workers are still there."""

Progress = Callable[[int], None]


@dataclass(frozen=True)
class Sweep:
    """A finished sweep: the table, one row for every loop, and how many an earlier start had computed."""

    table: pyarrow.Table
    keys: tuple[str, ...]
    loops: int
    found_before: int
    batches: int
    seconds_per_loop: float


def sweep(
    order: Order, values: Floats, path: Path, workers: Workers, progress: Progress | None = None
) -> Sweep:
    """Run all loops that `path` does not have yet.

    Parameters
    ----------
    order : Order
        Spec, keys and duration.
    values : (N, K) array
        What the keys are in every loop.
    path : Path
        Folder of the results; made if it is not there.
    workers : Workers
        Who runs the batches.
    progress : callable, optional
        Called with the number of loops done.

    Raises
    ------
    InputError
        When the folder has another sweep in it, or the workers are gone.
    """
    folder = Folder(path, _plan(order, values))
    before = folder.finished(values.shape[0])
    run = _Run(order, values, folder, workers, progress or (lambda done: None), before.size)
    order_of_work = sharing_order(order.keys, values)
    run.all(order_of_work[~np.isin(order_of_work, before)])
    return Sweep(
        folder.table(), order.keys, values.shape[0], int(before.size), run.batches, run.seconds_per_loop
    )


def _plan(order: Order, values: Floats) -> dict[str, Any]:
    import hashlib

    digest = hashlib.sha256(np.ascontiguousarray(values).tobytes()).hexdigest()
    return {**order._asdict(), "keys": list(order.keys), "loops": values.shape[0], "values_sha256": digest}


class _Run:
    def __init__(
        self,
        order: Order,
        values: Floats,
        folder: Folder,
        workers: Workers,
        progress: Progress,
        done: int,
    ) -> None:
        self.order, self.values, self.folder = order, values, folder
        self.workers, self.progress, self.done = workers, progress, done
        self.size, self.batches, self.seconds_per_loop = 1, 0, 0.0
        self.under_way: set[Future[Batch]] = set()

    def all(self, todo: Integers) -> None:
        """Run the loops `todo`."""
        self.progress(self.done)
        while todo.size or self.under_way:
            while todo.size and len(self.under_way) < BATCHES_AHEAD * self.workers.count:
                now, todo = np.split(todo, [self._fair(todo.size)])
                self.under_way.add(self._submit(now))
            self._collect()

    def _fair(self, left: int) -> int:
        """Size of the next batch; towards the end no worker gets more than its part of what is left."""
        return max(1, min(self.size, -(-left // self.workers.count)))

    def _submit(self, index: Integers) -> Future[Batch]:
        return self.workers.executor.submit(run_batch, self.order, index, self.values[index])

    def _collect(self) -> None:
        finished, self.under_way = wait(self.under_way, LOOK_S, return_when=FIRST_COMPLETED)
        for one in finished:
            batch = one.result()
            self.folder.add(batch, self.order.keys)
            self.batches += 1
            self.done += batch.index.size
            self._adapt(batch)
            self.progress(self.done)
        if not finished and not self.workers.there():
            raise InputError(
                "the Dask scheduler is gone; what is finished is kept, so start it and give the same "
                "command again."
            )

    def _adapt(self, batch: Batch) -> None:
        """Choose the next batches' size by what this one took."""
        self.seconds_per_loop = max(batch.seconds / batch.index.size, 1e-6)
        wanted = round(BATCH_S / self.seconds_per_loop)
        self.size = int(min(max(1, wanted), GROWTH * batch.index.size, LARGEST_BATCH))
