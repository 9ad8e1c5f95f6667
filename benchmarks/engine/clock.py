"""CPU time of calls, in interleaved rounds."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from statistics import median

LEAST = 0.01
"""CPU seconds that each call is given in a round."""


@dataclass
class Times:
    """CPU seconds of each call, round by round."""

    of: dict[str, list[float]] = field(default_factory=dict)

    def median(self, name: str) -> float:
        """Of all rounds."""
        return median(self.of[name])

    def ratio(self, name: str, unit: str) -> float:
        """Median of the ratios within each round: a machine that is slow for a while is so for both."""
        return median(one / other for one, other in zip(self.of[name], self.of[unit], strict=False))


def interleaved(calls: Mapping[str, Callable[[], object]], rounds: int, slow: Mapping[str, int]) -> Times:
    """Time calls: every round takes each in turn, those in `slow` in the first of them only."""
    times = Times({name: [] for name in calls})
    for name, call in calls.items():
        if slow.get(name, rounds) > 1:
            call()
    for turn in range(rounds):
        for name, call in calls.items():
            if turn < slow.get(name, rounds):
                times.of[name].append(_of_round(call))
    return times


def _of_round(call: Callable[[], object]) -> float:
    """CPU seconds of a call: median of as many as fill `LEAST`, since what was called before leaves a short
    call without its data in the nearest memory, which a long one soon fetches.
    """
    found: list[float] = []
    while sum(found) < LEAST:
        begin = time.process_time_ns()
        call()
        found.append((time.process_time_ns() - begin) * 1e-9)
    return median(found)
