"""Age of the data on every link at its use, beside what the spec says."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_analysis.dashboard.digits import rounded
from rthm_analysis.dashboard.fresh import Fresh
from rthm_analysis.timing.links import SOURCES, clock_of
from rthm_core.clock import NS
from rthm_core.link import Link
from rthm_core.schedule import Schedule

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rthm_core.spec import Spec

LOOKS = 10
"""How many looks a mean and a maximum are taken over: a second."""


class Use(NamedTuple):
    """Uses between two looks: how many, the sum of their ages and the largest one, ns."""

    count: int  # type: ignore[assignment]
    total: float
    largest: float


class Ages:
    """Ages of the data on all links.

    A sample is at least as old as the delay of its link. A receiver that looks at the ticks of its own clock
    may find it older, by up to one period of its source; that is no lateness.

    Parameters
    ----------
    spec : Spec
        A loop.
    """

    def __init__(self, spec: Spec) -> None:
        schedule = Schedule(spec)
        self._links = {name: Link(spec, name) for name in SOURCES}
        self._range = {}
        for name, link in self._links.items():
            source, receiver = clock_of(name, schedule)
            self._range[name] = link.delay_ns, link.reach_ns + (source if receiver else 0)
        self._uses: dict[str, deque[Use]] = {name: deque(maxlen=LOOKS) for name in SOURCES}
        self._worst = dict.fromkeys(SOURCES, 0.0)

    def add(self, fresh: Fresh) -> None:
        """Count uses."""
        for name, uses in self._uses.items():
            table = fresh.links.get(name)
            age = np.empty(0) if table is None else (table.use_ns - table.sample_ns).astype(float)
            uses.append(Use(len(age), float(age.sum()), float(age.max(initial=0.0))))
            self._worst[name] = max(self._worst[name], uses[-1].largest)

    def told(self) -> list[dict[str, Any]]:
        """Of every link, s: specified delay, oldest age that the schedule gives, mean and largest age of the
        last second, largest of the test.
        """
        found = []
        for name, uses in self._uses.items():
            count, total, largest = (f(column) for f, column in zip(_OVER, _columns(uses), strict=True))
            delay, oldest = self._range[name]
            figures = {
                "delay": delay / NS,
                "oldest": oldest / NS,
                "mean": total / count / NS if count else np.nan,
                "max": largest / NS if count else np.nan,
                "worst": self._worst[name] / NS if self._worst[name] else np.nan,
            }
            found.append({"name": name} | {key: rounded(value) for key, value in figures.items()})
        return found


_OVER: tuple[Callable[[Iterable[float]], float], ...] = (sum, sum, max)


def _columns(uses: deque[Use]) -> list[tuple[float, ...]]:
    return list(zip(*uses, strict=True)) if uses else [(0,), (0.0,), (0.0,)]
