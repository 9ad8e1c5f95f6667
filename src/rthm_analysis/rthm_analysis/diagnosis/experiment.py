"""The recorded test as something that can be repeated with another model of the physical side."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.evidence import Channel, Evidence
from rthm_analysis.diagnosis.grid import Grid, grid
from rthm_analysis.diagnosis.kernel import replay_mechanics
from rthm_analysis.diagnosis.mechanics import fastest, mechanics
from rthm_analysis.diagnosis.motor import motor_delay, motor_motion
from rthm_analysis.diagnosis.sensing import sensed
from rthm_analysis.diagnosis.windows import Windows
from rthm_core.effects import effect
from rthm_core.spec import apply

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

LONGEST_PHASE = 0.35
"""Longest step of a replay, in radians of the fastest motion of the mechanics."""

MOST_SUBSTEPS = 50

KEPT = 3
"""Motions that are kept."""

SENSORS = ("sensor.position", "sensor.velocity", "sensor.force")


@dataclass(frozen=True)
class Motion:
    """What a model of the physical side does in the recorded test.

    Attributes
    ----------
    position, velocity, acceleration : (s, n) arrays
    force, motor : (s, m) arrays
        Wire forces and motor positions.
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    force: Floats
    motor: Floats


@dataclass
class Experiment:
    """Recorded inputs, ready to be replayed; keeps the motor motion of models with the same motors.

    Parameters
    ----------
    evidence : Evidence
    first : (m,) array
        Command that had been there for ever before the test.
    held : bool
        Whether a load that is known by its samples is held between them; else it is smooth.
    """

    evidence: Evidence
    first: Floats
    held: bool = False
    _motors: dict[str, tuple[Grid, Floats, Floats]] = field(default_factory=dict)
    _motions: dict[str, Motion] = field(default_factory=dict)
    _lock: Lock = field(default_factory=Lock)

    def motion(self, spec: Spec, windows: Windows) -> Motion:
        """Motion of the physical side of `spec` under the recorded inputs; kept for the last few models."""
        bare = _without_sensors(spec)
        key = repr(bare) + str(hash(windows.state.tobytes()))
        with self._lock:
            kept = self._motions.get(key)
        if kept is None:
            kept = self._moved(bare, windows)
            with self._lock:
                while len(self._motions) > KEPT:
                    self._motions.pop(next(iter(self._motions)))
                self._motions[key] = kept
        return kept

    def predicted(self, spec: Spec, windows: Windows) -> Floats:
        """What the sensors of `spec` would have read, without noise: (s, k), one column per channel."""
        motion = self.motion(spec, windows)
        assert spec.plant is not None
        columns = []
        for channel in self.evidence.channels:
            places = spec.plant.dofs if channel.family in ("position", "velocity") else spec.actuator.names  # type: ignore[union-attr]
            true = getattr(motion, channel.family)[:, places.index(channel.place)]
            columns.append(sensed(self.evidence.time, true, _effects_on(spec, channel)))
        return np.stack(columns, axis=1)

    def _moved(self, spec: Spec, windows: Windows) -> Motion:
        points, motor, load = self._inputs(spec)
        if all(channel.family == "motor" for channel in self.evidence.channels):
            nothing = np.empty((points.sample.size, 0))
            return Motion(nothing, nothing, nothing, nothing, motor[points.sample, 0])
        arrays = mechanics(spec, motor[0, 0])
        longest = float(np.diff(points.time).max(initial=0.0))
        substeps = min(max(1, math.ceil(longest * fastest(arrays, spec) / LONGEST_PHASE)), MOST_SUBSTEPS)
        n, m = load.shape[2], motor.shape[2]
        out = np.zeros((points.sample.size, 3 * n + m))
        starts = points.sample[windows.start]
        replay_mechanics(
            arrays, points.time, substeps, motor, load, starts, windows.state, points.sample, out
        )
        x, v, force, a = np.split(out, [n, 2 * n, 2 * n + m], axis=1)
        return Motion(x, v, a, force, motor[points.sample, 0])

    def _inputs(self, spec: Spec) -> tuple[Grid, Floats, Floats]:
        """Grid, motor positions and known loads on it; kept for models that do not differ in them."""
        key = repr([e for e in spec.effects if _drives(e)]) + repr(
            spec.actuator and spec.actuator.motor_poles
        )
        with self._lock:
            kept = self._motors.get(key)
        if kept is None:
            kept = self._new_inputs(spec)
            with self._lock:
                while len(self._motors) > KEPT:
                    self._motors.pop(next(iter(self._motors)))
                self._motors[key] = kept
        return kept

    def _new_inputs(self, spec: Spec) -> tuple[Grid, Floats, Floats]:
        e = self.evidence
        due = e.due_ns + motor_delay(spec)
        points = grid(e.stamps_ns, due, 20_000_000)
        m = e.commands.shape[1] if e.driven_by == "command" else 0
        motor = np.zeros((points.time_ns.size, 3, m))
        if m:
            motor = motor_motion(spec, points.time_ns, due, e.commands, self.first)
        return points, motor, self._load(points) + _hidden_loads(spec, points)

    def _load(self, points: Grid) -> Floats:
        """Known loads on the grid: (g, 3, n)."""
        time, load = self.evidence.time, self.evidence.load
        if not np.any(load):
            return np.zeros((points.time_ns.size, 3, load.shape[1]))
        if self.held:
            row = np.searchsorted(self.evidence.stamps_ns, points.time_ns, side="right") - 1
            return np.repeat(load[row][:, None, :], 3, axis=1)
        from scipy.interpolate import CubicSpline

        return np.asarray(CubicSpline(time, load)(np.minimum(points.points, time[-1])))


def _drives(one) -> bool:  # type: ignore[no-untyped-def]
    return one.block == "motor" or one.kind in ("harmonic_load", "constant_load")


def _without_sensors(spec: Spec) -> Spec:
    if not any(e.block in SENSORS for e in spec.effects):
        return spec
    return apply(spec, {"effects": [e.name for e in spec.effects if e.block not in SENSORS]})


def _effects_on(spec: Spec, channel: Channel) -> list:  # type: ignore[type-arg]
    return [e for e in spec.effects if e.block == f"sensor.{channel.family}" and e.place == channel.place]


def _hidden_loads(spec: Spec, points: Grid) -> Floats:
    """Loads of effects that depend on time alone: (g, 3, n)."""
    assert spec.plant is not None
    loads = np.zeros((points.time_ns.size, 3, len(spec.plant.dofs)))
    for one in spec.effects:
        if one.block != "plant":
            continue
        law = effect(one.kind, one.block)
        shape = law.excitation(tuple(float(one.parameters[p]) for p in law.parameters))  # type: ignore[attr-defined]
        if shape is not None:
            constant, amplitude, frequency, phase = shape
            loads[:, :, spec.plant.dofs.index(str(one.dof))] += constant + amplitude * np.sin(
                frequency * points.points + phase
            )
    return loads
