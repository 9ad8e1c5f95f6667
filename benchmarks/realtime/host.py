"""How long the machine itself keeps a thread from running: what no program on it can be better than."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TypedDict

NOTED = 100_000
"""Shortest interruption that is counted, ns; some of a few microseconds are part of any kernel."""

SPIN = 2_000_000
"""Time on a core before a short sleep, ns; a thread that never sleeps is stopped for that alone."""


class Interruptions(TypedDict):
    """Longest interruption in s, and the share of time that all of them took."""

    longest: float
    share: float


def interruptions(seconds: float = 3.0) -> Interruptions:
    """Interruptions of a thread with real-time priority that only reads the clock, on the worst core."""
    cores = sorted(os.sched_getaffinity(0))
    command = [sys.executable, "-m", "benchmarks.realtime.host", str(seconds)]
    watchers = [subprocess.Popen([*command, str(core)], stdout=subprocess.PIPE, text=True) for core in cores]
    found: list[Interruptions] = [json.loads(watcher.communicate()[0]) for watcher in watchers]
    return {key: max(one[key] for one in found) for key in ("longest", "share")}  # type: ignore[return-value]


@contextmanager
def taken() -> Iterator[dict[str, float]]:
    """Tell, as ``taken``, the share of all cores' time that a hypervisor gives to others meanwhile."""
    told: dict[str, float] = {}
    before = _spent()
    yield told
    whole, stolen = (after - first for after, first in zip(_spent(), before, strict=True))
    told["taken"] = stolen / max(whole, 1)


def _spent() -> tuple[int, int]:
    """Time of all cores since the start of the system, and how much of it was stolen, in ticks."""
    spent = [int(word) for word in Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]]
    return sum(spent), spent[7]


def watch(seconds: float, core: int) -> Interruptions:
    """Read the clock on one core, in stretches with a short sleep between them."""
    os.sched_setaffinity(0, {core})
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(50))
    gaps: list[int] = []
    begin = last = time.monotonic_ns()
    end, rest = begin + int(seconds * 1e9), begin + SPIN
    while last < end:
        now = time.monotonic_ns()
        if now - last > NOTED:
            gaps.append(now - last)
        last = now
        if now > rest:
            time.sleep(1e-4)
            last = time.monotonic_ns()
            rest = last + SPIN
    return {"longest": max(gaps, default=0) * 1e-9, "share": sum(gaps) / (last - begin)}


if __name__ == "__main__":
    print(json.dumps(watch(float(sys.argv[1]), int(sys.argv[2]))))
