"""Many loops, a long loop, and the start of the program."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from rthm_core.engine import simulate_blocks, simulate_many
from rthm_core.spec import Spec


def per_loop(spec: Spec, duration: float, sample: float, count: int = 1024) -> float:
    """CPU seconds per loop of an ensemble with masses and stiffnesses of their own, best of three."""
    chance = np.random.default_rng(1)
    varied = {
        "plant.mass": chance.uniform(1.0, 2.0, count),
        "numerical.stiffness": chance.uniform(4.0, 8.0, count),
        "actuator.stiffness": chance.uniform(30.0, 50.0, count),
    }
    simulate_many(spec, varied, duration, sample)
    times = []
    for _ in range(3):
        begin = time.process_time()
        simulate_many(spec, varied, duration, sample)
        times.append(time.process_time() - begin)
    return min(times) / count


def long_run(spec: Spec, duration: float, sample: float) -> tuple[float, float]:
    """CPU seconds of a run in blocks, and what it added to the peak memory, in MB."""
    for _ in simulate_blocks(spec, 30.0, sample):
        pass
    before, begin = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    for _ in simulate_blocks(spec, duration, sample):
        pass
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return time.process_time() - begin, (after - before) / 1024


def starts(times: int = 3) -> tuple[float, float]:
    """CPU seconds of ``rthm simulate`` for 20 s: the first use after installation, and a later one."""
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"RTHM_CACHE_DIR": folder}
        rthm = str(Path(sys.executable).parent / "rthm")
        command = [rthm, "simulate", "paper", "--duration", "20", "--out", str(Path(folder) / "run.npz")]

        def once() -> float:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

        return once(), min(once() for _ in range(times))
