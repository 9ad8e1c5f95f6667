"""CPU time of calls, in interleaved rounds."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from statistics import median


def interleaved(
    calls: Mapping[str, Callable[[], object]], rounds: int, slow: Mapping[str, int]
) -> dict[str, float]:
    """Median CPU seconds of each call.

    Every round takes each once, in turn; those in `slow` only in so many of the first rounds.
    """
    times: dict[str, list[float]] = {name: [] for name in calls}
    for name, call in calls.items():
        if slow.get(name, rounds) > 1:
            call()
    for turn in range(rounds):
        for name, call in calls.items():
            if turn < slow.get(name, rounds):
                begin = time.process_time_ns()
                call()
                times[name].append((time.process_time_ns() - begin) * 1e-9)
    return {name: median(found) for name, found in times.items()}
