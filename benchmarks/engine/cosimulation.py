"""The loop as a co-simulation of two FMUs, with FMPy as the master that holds and delays."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.engine.limit import compiler
from benchmarks.engine.others import Entry, matrices, start

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.schedule import COMMAND, MOTOR, OUTPUT, REFERENCE, SAMPLE, Schedule
from rthm_core.spec import Spec

IN0, IN1, X, V = 4, 5, 6, 7
"""Value references of ``mass_fmu.c``."""


def unit() -> Path:
    """Folder of the unpacked FMU, compiled on the spot."""
    folder = Path(tempfile.mkdtemp(prefix="rthm-fmu-"))
    binaries = folder / "binaries" / "linux64"
    binaries.mkdir(parents=True)
    source = Path(__file__).with_name("mass_fmu.c")
    target = binaries / "mass.so"
    subprocess.run([compiler(), "-O3", "-shared", "-fPIC", str(source), "-o", str(target), "-lm"], check=True)
    return folder


def _slave(folder: Path, name: str, a: Floats, b: Floats, y: Floats) -> Any:
    from fmpy.fmi2 import FMU2Slave

    slave = FMU2Slave(guid="mass", unzipDirectory=str(folder), modelIdentifier="mass", instanceName=name)
    slave.instantiate()
    slave.setupExperiment()
    slave.enterInitializationMode()
    inputs = [*b[1], 0.0][:2]
    slave.setReal([0, 1, 2, 3, X, V], [a[1, 0], a[1, 1], *inputs, y[0], y[1]])
    slave.exitInitializationMode()
    return slave


def co_simulated(spec: Spec, duration: float, sample: float) -> Entry:
    """FMPy: a communication point at every event, whose order is taken from the schedule."""
    one, b1, two, b2 = matrices(spec)
    y0, force0 = start(spec)
    face, k_tot, folder = spec.loop().interface, spec.k_tot[0], unit()
    events = [
        tuple(int(x) for x in event)
        for event in zip(*Schedule(spec).events(0, to_ns(duration) + 1, to_ns(sample)), strict=True)
        if event[1] != COMMAND
    ]

    def call() -> list[float]:
        plant, numerical = (
            _slave(folder, "plant", one, b1, y0[:2]),
            _slave(folder, "numerical", two, b2, y0[2:]),
        )
        first = (float(y0[0]), float(y0[1]))
        plant.setReal([IN0], [first[0] + force0 / k_tot])
        numerical.setReal([IN0, IN1], first)
        samples, references, rows, now = {-1: first}, {-1: force0}, [], 0
        for time, what, index, state, reference in events:
            if time > now:
                plant.doStep(now * 1e-9, (time - now) * 1e-9)
                numerical.doStep(now * 1e-9, (time - now) * 1e-9)
                now = time
            if what == SAMPLE:
                samples[index] = tuple(plant.getReal([X, V]))
            elif what == REFERENCE:
                held, (x2, v2) = samples[state], numerical.getReal([X, V])
                numerical.setReal([IN0, IN1], held)
                references[index] = -face.damping[0] * (held[1] - v2) - face.stiffness[0] * (held[0] - x2)
            elif what == MOTOR:
                plant.setReal([IN0], [samples[state][0] + references[reference] / k_tot])
            elif what == OUTPUT:
                rows.append(plant.getReal([X])[0])
        for slave in (plant, numerical):
            slave.terminate()
            slave.freeInstance()
        return rows

    return call, np.array
