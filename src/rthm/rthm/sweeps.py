"""Sweeps over the numbers of a spec."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt

from rthm.results import Column, Result
from rthm.specs import Named, load
from rthm_analysis.sweep.folder import column
from rthm_analysis.sweep.ranges import Range, numbers
from rthm_analysis.sweep.run import sweep_over, values_of
from rthm_analysis.sweep.sweep import Sweep as SweepTable


class Sweep(Result, SweepTable):
    """Table of many loops, one row for each; ``table`` is an Arrow table with all of its columns."""

    def columns(self) -> dict[str, Column]:
        """What was varied, and every number that was found; NaN: cannot be told."""
        names = (name for name in self.table.column_names if name not in ("loop", "stable", "refused"))
        first = dict.fromkeys((*self.keys, *names))
        return {name: Column(column(self.table, name), "") for name in first}

    def shown(self) -> list[str]:
        """Growth rate of the slowest mode, 1/s."""
        return ["growth_rate"]


def sweep(
    spec: Named,
    values: Mapping[str, npt.ArrayLike | str],
    duration: float = 20.0,
    *,
    folder: str | Path | None = None,
    workers: int = 1,
) -> Sweep:
    """Run loops with all combinations of some values.

    Parameters
    ----------
    spec : str, Path or Spec
        Name of a shipped spec, path, or spec.
    values : mapping of str to array or str
        Values of entries of the spec, or ``"a:b:n"``; ``timing.scale`` is a factor on all periods and delays.
    duration : float
        Length of every simulation, s; 0: stability alone.
    folder : str or Path, optional
        Where results are kept; a sweep that was interrupted goes on from there. Not kept when absent.
    workers : int
        Processes; more than one only where the script guards its start with ``if __name__ == "__main__"``.

    Returns
    -------
    Sweep

    Raises
    ------
    InputError
        If a key or a value is not allowed, the folder has another sweep in it, or pyarrow is not installed.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.sweep("paper", {"timing.scale": [1.0, 30.0]}, 0.0)
    >>> found.table["stable"].to_pylist()
    [True, False]
    """
    test, ranges = load(spec), [_range(key, given) for key, given in values.items()]
    with TemporaryDirectory() as unkept:
        place = Path(unkept if folder is None else folder)
        found = sweep_over(test, ranges, values_of(test, ranges), place, duration, workers)
    return Sweep.of(found)


def _range(key: str, given: npt.ArrayLike | str) -> Range:
    if isinstance(given, str):
        return Range(key, *numbers(given))
    return Range(key, np.atleast_1d(np.asarray(given, dtype=float)))
