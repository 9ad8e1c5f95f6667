"""How far recordings are from simulations along the delays that they had, and from each other."""

from __future__ import annotations

from math import prod
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.timing import RecordedSchedule, timing_of
from rthm_core.chance import normal
from rthm_core.compiled import Floats, Integers
from rthm_core.engine import simulate
from rthm_core.spec import Spec

SIGNALS = {"x1": ("position", "x1"), "F": ("force", "a1")}
"""Sensor of each signal that is compared, and where it is."""


class Run(NamedTuple):
    """A run of the node graph: its bag, the recording in it, and how many samples were used late."""

    bag: Path
    recording: Recording
    late: int


def read_run(bag: Path) -> Run:
    """Run that was recorded in `bag`."""
    recording = read_recording(bag)
    links = timing_of(recording, recording.spec).links
    return Run(bag, recording, sum(link.late for link in links.values()))


def off_along_delays(one: Run, spec: Spec, signal: str) -> float:
    """Rms difference of a signal between a run and `spec` simulated along the run's delays, over its
    deviation.
    """
    ticks, recorded = _measured(one.recording, signal)
    schedule = RecordedSchedule(spec, one.recording)
    motion = simulate(spec, one.recording.duration, energies=False, schedule=schedule)
    values = motion.plant_position if signal == "x1" else _scale(spec) * motion.actuator_force
    return _off(recorded, values[ticks, 0])


def off_each_other(one: Run, other: Run, signal: str) -> float:
    """Rms difference of a signal between two runs, over its deviation in the first."""
    first, second = (_measured(run.recording, signal)[1] for run in (one, other))
    count = min(first.size, second.size)
    return _off(first[:count], second[:count])


def _measured(recording: Recording, signal: str) -> tuple[Integers, Floats]:
    """Ticks of Td1, and the signal at them without the noise of its sensor, which the spec's seed tells."""
    plant, spec, (sensor, where) = recording.plant, recording.spec, SIGNALS[signal]
    assert spec is not None and spec.timing is not None
    stamps = plant.stamp_ns - recording.start_ns
    noise = getattr(spec.noise, sensor) * normal(int(spec.noise.seed), f"{sensor}.{where}", stamps)
    values = plant.columns("position" if signal == "x1" else "effort", [where])[:, 0]
    return stamps // spec.timing.ns("td1"), values - noise


def _scale(spec: Spec) -> float:
    """By how much the sensor of the force shows too much."""
    sensors = (one for one in spec.effects if one.block == "sensor.force" and one.kind == "scale")
    return prod(float(one.parameters["scale"]) for one in sensors)


def _off(first: Floats, second: Floats) -> float:
    return float(np.sqrt(np.nanmean(np.square(first - second))) / np.nanstd(first))
