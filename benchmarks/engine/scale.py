"""Many loops, a long loop, and the start of the program."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from benchmarks.engine import THREADS
from benchmarks.engine.clock import interleaved

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.matrices import linear_loop
from rthm_analysis.stability.rates import of_scale
from rthm_core.engine import sensitivities, simulate, simulate_blocks, simulate_many
from rthm_core.spec import Spec

COUNT = 1024
"""How many loops or checks are done together."""

LOOPS, CORES = 10_000, 2
"""How many loops a sweep has, and how many processes run them."""


def with_masses(spec: Spec, duration: float, sample: float) -> Callable[[], object]:
    """Loops with masses and stiffnesses of their own."""
    chance = np.random.default_rng(1)
    varied = {
        "plant.mass": chance.uniform(1.0, 2.0, COUNT),
        "numerical.stiffness": chance.uniform(4.0, 8.0, COUNT),
        "actuator.stiffness": chance.uniform(30.0, 50.0, COUNT),
    }
    return lambda: simulate_many(spec, varied, duration, sample)


def with_delays(spec: Spec, duration: float, sample: float) -> Callable[[], object]:
    """Loops with delays of their own, to the nanosecond."""
    chance = np.random.default_rng(2)
    factors = {name: chance.uniform(0.5, 1.5, COUNT) for name in ("tau1", "tau2", "tau3", "tau4")}
    varied = {f"timing.{name}": getattr(spec.timing, name) * factor for name, factor in factors.items()}
    return lambda: simulate_many(spec, varied, duration, sample)


def stability_checks(spec: Spec) -> Callable[[], object]:
    """Checks of loops whose clocks and delays grow together."""
    factors = np.linspace(0.1, 3.0, COUNT)
    rates = of_scale(linear_loop(spec), period_of(spec).cycle)
    return lambda: rates(factors)


def per_one(calls: dict[str, Callable[[], object]], unit: Callable[[], object] | None) -> dict[str, float]:
    """CPU seconds for one of the `COUNT` of each call; as ``..._ratio``, in units of a call of `unit`."""
    every = calls | ({"unit": lambda: [unit() for _ in range(100)]} if unit else {})
    times = interleaved(every, 21, {})
    found = {name: times.median(name) / COUNT for name in calls}
    if unit:
        found |= {f"{name}_ratio": times.ratio(name, "unit") * 100 / COUNT for name in calls}
    return found


def sensitive(spec: Spec, duration: float, sample: float) -> dict[str, float]:
    """CPU seconds of a simulation with sensitivities to all parameters, their number, and the ratio to the
    same simulation without them; and the same where works are counted in both.
    """
    calls: dict[str, Callable[[], object]] = {
        "without": lambda: simulate(spec, duration, sample, energies=False),
        "sensitive": lambda: sensitivities(spec, duration, sample=sample, energies=False),
        "counting": lambda: simulate(spec, duration, sample),
        "counting_sensitive": lambda: sensitivities(spec, duration, sample=sample),
    }
    times = interleaved(calls, 31, {})
    return {
        "parameters": len(sensitivities(spec, 0.1, sample=sample).by_parameter),
        "sensitive": times.median("sensitive"),
        "sensitive_ratio": times.ratio("sensitive", "without"),
        "counting_sensitive": times.median("counting_sensitive"),
        "counting_sensitive_ratio": times.ratio("counting_sensitive", "counting"),
    }


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
        command = ["simulate", "paper", "--duration", "20", "--out", str(Path(folder) / "run.npz")]

        def once() -> float:
            return _verb(command, {"RTHM_CACHE_DIR": folder}).cpu

        return once(), min(once() for _ in range(times))


def swept() -> dict[str, float]:
    """Wall and CPU seconds of ``rthm sweep`` over a grid of `LOOPS` loops of 20 s on `CORES` processors, from
    its start to its picture; compiled code is there already.
    """
    side = round(LOOPS**0.5)

    def once(count: int) -> _Spent:
        with tempfile.TemporaryDirectory() as folder:
            grid = ["--set", f"timing.tau4=0:0.03:{count}", "--set", f"plant.damping=0.01:0.1:{count}"]
            workers = ["--workers", str(CORES), "--yes", "--out", folder]
            return _verb(["sweep", "paper", *grid, "--duration", "20", *workers], {})

    once(2)
    spent = once(side)
    return {"sweep_loops": side**2, "sweep": spent.wall, "sweep_cpu": spent.cpu}


class _Spent(NamedTuple):
    """Seconds that a command took, and those that its processors worked for it."""

    wall: float
    cpu: float


def _verb(command: list[str], environment: dict[str, str]) -> _Spent:
    """Run ``rthm`` as a user does, whose libraries choose their threads."""
    users = {name: value for name, value in os.environ.items() if name not in THREADS}
    rthm = str(Path(sys.executable).parent / "rthm")
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([rthm, *command], env=users | environment, check=True, stdout=subprocess.DEVNULL)
    wall, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    return _Spent(wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
