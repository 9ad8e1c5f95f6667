"""The index as a table: rows of text, the heading first. Terminal and page show the same."""

from __future__ import annotations

import math
from collections.abc import Iterable

from rthm_analysis.runs.index import Run

UNKNOWN = "-"

HEAD = ("run", "begun", "length", "outcome", "error", "problems", "spec")


def rows(runs: Iterable[Run]) -> list[tuple[str, ...]]:
    """One row for each run."""
    return [HEAD, *(_row(run) for run in runs)]


def _row(run: Run) -> tuple[str, ...]:
    return (
        run.name,
        f"{run.begun:%Y-%m-%d %H:%M:%S}",
        f"{run.duration:.4g} s" if math.isfinite(run.duration) else UNKNOWN,
        run.outcome,
        f"{100.0 * run.worst:.3g} %" if math.isfinite(run.worst) else UNKNOWN,
        str(len(run.problems)) if run.problems else "none",
        run.spec or UNKNOWN,
    )
