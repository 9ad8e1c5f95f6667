"""The index of a folder of runs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rthm_core.errors import InputError, printable

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class Run:
    """One run, as it is told by what it left.

    Attributes
    ----------
    name : str
        Its folder, or the file of a trajectory, in the folder of runs.
    path : Path
    spec : str
        Name of the spec, or the shipped one that it is most like and what is changed; empty: not known.
    begun : datetime
        In local time.
    duration : float
        Length of the recording, s; NaN: not known.
    outcome : str
        ``stable``, ``unstable``, ``aborted``, ``not judged`` (no loop, or a trajectory) or ``no report``.
    error : dict of float
        Root mean square error of each dof against the ideal system, over that of the ideal motion.
    problems : tuple of str
        What went wrong, a sentence each.
    """

    name: str
    path: Path
    spec: str
    begun: datetime
    duration: float
    outcome: str
    error: dict[str, float] = field(default_factory=dict)
    problems: tuple[str, ...] = ()

    @property
    def worst(self) -> float:
        """Largest error of a dof; NaN: not known."""
        return max(self.error.values(), default=math.nan)

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON (docs/how-to/compare-tests.md)."""
        return {
            "name": self.name,
            "path": str(self.path),
            "spec": self.spec or None,
            "begun": self.begun.isoformat(timespec="seconds"),
            "duration": self.duration,
            "outcome": self.outcome,
            "error": self.error,
            "problems": list(self.problems),
        }


ORDERS: dict[str, tuple[Callable[[Run], Any], bool]] = {
    "date": (lambda run: run.begun, True),
    "name": (lambda run: run.name, False),
    "spec": (lambda run: run.spec, False),
    "length": (lambda run: _known_first(run.duration), True),
    "error": (lambda run: _known_first(run.worst), True),
    "outcome": (lambda run: run.outcome, False),
    "problems": (lambda run: len(run.problems), True),
}
"""What runs can be sorted by, and whether the largest comes first."""


def _known_first(value: float) -> float:
    """Value to sort by from the largest down, with what is not known last."""
    return -math.inf if math.isnan(value) else value


def runs_in(folder: Path) -> list[Run]:
    """Runs and trajectories of a folder, newest first.

    Raises
    ------
    InputError
        It is not a folder.
    """
    from rthm_analysis.runs.reading import is_run, read_run, read_trajectory_file

    if not folder.is_dir():
        raise InputError(
            f"{printable(str(folder))} is not a folder of runs; rthm run makes out/ with the first one, or "
            "name another folder."
        )
    places = sorted(folder.iterdir())
    found = [read_run(place) for place in places if is_run(place)]
    found += [read_trajectory_file(place) for place in places if place.suffix == ".npz" and place.is_file()]
    return sorted_runs(found, "date")


def sorted_runs(runs: Iterable[Run], order: str) -> list[Run]:
    """Runs in one of the `ORDERS`; InputError for another."""
    if order not in ORDERS:
        raise InputError(f"--sort is {order!r}, but must be one of {', '.join(ORDERS)}; give one of them.")
    key, falling = ORDERS[order]
    return sorted(runs, key=key, reverse=falling)
