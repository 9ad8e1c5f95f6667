"""From ranges of values to a finished sweep."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rthm_analysis.sweep.batch import Order
from rthm_analysis.sweep.points import check_ends, draws, grid
from rthm_analysis.sweep.ranges import Range
from rthm_analysis.sweep.sweep import Progress, Sweep, sweep
from rthm_analysis.sweep.workers import cluster_workers, cores, local_workers
from rthm_core.compiled import Floats
from rthm_core.errors import InputError, refusal

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def values_of(spec: Spec, ranges: Sequence[Range], draw: int | None = None, seed: int = 0) -> Floats:
    """Values (N, K) of all loops: every combination, or so many random draws between the ends.

    Raises
    ------
    InputError
        If the spec does not allow an end of a range.
    """
    check_ends(spec, ranges)
    return grid(ranges) if draw is None else draws(ranges, draw, seed)


def sweep_over(
    spec: Spec,
    ranges: Sequence[Range],
    values: Floats,
    folder: Path,
    duration: float,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Run all loops that a folder does not have yet.

    Parameters
    ----------
    spec : Spec
    ranges : sequence of Range
        What is varied.
    values : (N, K) array
        As `values_of` gives them.
    folder : Path
        Of the results; made if it is not there.
    duration : float
        Length of every simulation, s; 0: stability alone.
    workers : int, optional
        Processes; one for each processor when absent.
    scheduler : str, optional
        Address of a Dask scheduler, instead of processes of this machine.
    progress : callable, optional
        Called with the number of loops done.

    Raises
    ------
    InputError
        If one of these is not allowed, or the folder has another sweep in it.
    """
    if not 0.0 <= duration < 1e6:
        raise refusal("--duration", duration, "from 0 (stability alone) to 1e6 s")
    if workers is not None and workers < 1:
        raise refusal("--workers", workers, "at least 1", "leave it out for one on each processor")
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file, but must be a folder or not be there yet; give another name.")
    order = Order(spec.expanded(), tuple(one.key for one in ranges), duration)
    with local_workers(workers or cores()) if scheduler is None else cluster_workers(scheduler) as crew:
        return sweep(order, values, folder, crew, progress)
