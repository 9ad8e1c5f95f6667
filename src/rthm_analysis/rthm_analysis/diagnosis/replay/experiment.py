"""The recorded test as something that can be repeated with another model of the physical side."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from threading import Lock
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import (
    GRID_PERIOD_SHARE,
    INPUTS_KEPT,
    LONGEST_GRID_INTERVAL_NS,
    MOTION_BYTES,
    MOTIONS_KEPT,
    WIRELESS_STEP_COST,
)
from rthm_analysis.diagnosis.replay.between import Between
from rthm_analysis.diagnosis.replay.budget import Budget
from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel, Evidence
from rthm_analysis.diagnosis.replay.grid import Grid, grid
from rthm_analysis.diagnosis.replay.kernel import Replay, replay_mechanics, working
from rthm_analysis.diagnosis.replay.loads import hidden_loads, load_on, on_columns, straight
from rthm_analysis.diagnosis.replay.mechanics import mechanics
from rthm_analysis.diagnosis.replay.motor import held_motion, motor_delay, motor_motion
from rthm_analysis.diagnosis.replay.resolution import can_be_sharper, longest_interval, steps_in, worth
from rthm_analysis.diagnosis.replay.sensing import lagged, levelled, sensed, time_constant
from rthm_core.clock import NS
from rthm_core.spec import apply
from rthm_core.spec.effect import sizes

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.windows import Windows
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import EffectSpec


SENSORS = tuple(f"sensor.{family}" for family in (*MOTION, "force"))


class Inputs(NamedTuple):
    """What moves the physical side.

    Attributes
    ----------
    points : Grid
        Of the replay.
    motor, load : (g, 3, m), (g, 3, n) arrays
        On it: motor positions, known loads on the dofs.
    fine : Grid
        With every sample, and every instant at which a motor jumps.
    course : (f, 3, m) array
        Motor positions on the fine grid.
    samples : (s,) array
        Where the samples are on the fine grid.
    further : (g, 3, n) array or None
        Trial forces on the dofs, of which no law knows.
    """

    points: Grid
    motor: Floats
    load: Floats
    fine: Grid
    course: Floats
    samples: Integers
    further: Floats | None = None


class Motion(NamedTuple):
    """What a model of the physical side does in the recorded test, at some instants.

    Attributes
    ----------
    position, velocity, acceleration : (..., n) arrays
    force, motor : (..., m) arrays
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
        Command in steady state before the test.
    starts_ns : (r,) array
        Instants at which free runs may begin.
    between : Between
        How a load that is known by its samples goes between them.
    sharp : bool
        Whether the grid is as fine as wires that remember their path need it.
    loads : Evidence, optional
        What tells the loads, where it has more samples than `evidence`, as in a draft; its steps are coarser.
    budget : Budget
        Charged with every prediction, whether its motion was kept or not.
    seen : int, optional
        Samples from which the offsets of accelerometers are taken; by default all.
    """

    evidence: Evidence
    first: Floats
    starts_ns: Integers = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    between: Between = Between.SMOOTH
    sharp: bool = False
    loads: Evidence | None = None
    budget: Budget = field(default_factory=Budget)
    seen: int | None = None
    _motors: dict[str, Inputs] = field(default_factory=dict)
    _motions: dict[str, tuple[Motion, int]] = field(default_factory=dict)
    _grids: dict[tuple[int, int, bool], Grid] = field(default_factory=dict)
    _lock: Lock = field(default_factory=Lock)

    def begin_at(self, starts_ns: Integers) -> None:
        """Let free runs begin at some instants."""
        self.starts_ns = starts_ns
        self._forget()

    def beginning_at(self, starts_ns: Integers) -> Experiment:
        """The same test in free runs of its own, which begin at some instants."""
        return replace(self, starts_ns=starts_ns, _motors={}, _motions={}, _grids={}, _lock=Lock())

    def loaded_by(self, load: Floats) -> Experiment:
        """The same test under other known loads (s, n)."""
        evidence = replace(self.evidence, load=load)
        return replace(self, evidence=evidence, _motors={}, _motions={}, _grids={}, _lock=Lock())

    def sharpen(self, spec: Spec) -> bool:
        """Refine the grid from now on if a wire of this model needs it, but for a draft; whether anything
        changed.
        """
        if self.sharp or self.is_draft or not can_be_sharper(spec):
            return False
        self.sharp = True
        self._forget()
        return True

    def under(self, force: Floats, time: Floats) -> Experiment:
        """The same test with trial forces (g, n), N, on the dofs, straight between the instants (g,), s, at
        which they are given.
        """

        def with_force(inputs: Inputs) -> Inputs:
            more = straight(inputs.points, time, force)
            return inputs._replace(further=more if inputs.further is None else inputs.further + more)

        with self._lock:
            motors = {key: with_force(inputs) for key, inputs in self._motors.items()}
            grids = dict(self._grids)
        return replace(self, _motors=motors, _motions={}, _grids=grids, _lock=Lock())

    def draft(self, kept: Integers | slice = slice(None)) -> Experiment:
        """The same test in coarser steps, with the samples that are kept."""
        e = self.evidence
        loads = self.loads or e
        return Experiment(e.kept(kept), self.first, self.starts_ns, self.between, False, loads, self.budget)

    @property
    def is_draft(self) -> bool:
        """Whether it takes some of the samples only, and coarser steps."""
        return self.loads is not None

    def _forget(self) -> None:
        self._motors.clear()
        self._motions.clear()
        self._grids.clear()

    def motion(self, spec: Spec, windows: Windows) -> Motion:
        """Motion (s, ...) of the physical side of `spec` under the recorded inputs, at the samples; kept for
        the last few models.
        """
        bare = _without_sensors(spec)
        return self._motion(bare, _key(bare, windows), windows, between=False)[0]

    def _motion(self, bare: Spec, key: str, windows: Windows, *, between: bool) -> tuple[Motion, int]:
        """Motion at the samples (s, ...), or in each interval of the fine grid (f, 3, ...), and its steps.

        `key` tells the model and the windows from others.
        """
        key += str(between)
        with self._lock:
            kept = self._motions.get(key)
        if kept is None:
            kept = self._moved(bare, windows, between=between)
        size = sum(one.nbytes for one in kept[0])
        self._keep(self._motions, key, kept, max(MOTIONS_KEPT, MOTION_BYTES // max(size, 1)))
        return kept

    def _keep(self, results: dict[Any, Any], key: Any, value: Any, most: int = INPUTS_KEPT) -> None:
        """Keep the results that were asked for last, `most` of them before this one."""
        with self._lock:
            results.pop(key, None)
            while len(results) > most:
                results.pop(next(iter(results)))
            results[key] = value

    def predicted(self, spec: Spec, windows: Windows) -> Floats:
        """What the sensors of `spec` would have read, without noise: (s, k), one column per channel.

        Accelerations have the offset that leaves least of each recording: every accelerometer has one. So has
        what is known to have a zero of its own in each.
        """
        assert spec.plant is not None
        bare, channels = _without_sensors(spec), self.evidence.channels
        effects = [effects_on(spec, channel) for channel in channels]
        lags = [time_constant(some) for some in effects]
        between = any(lags)
        motion, steps = self._motion(bare, _key(bare, windows), windows, between=between)
        inputs = self._inputs(spec) if between else None
        columns = []
        for channel, some, lag in zip(channels, effects, lags, strict=True):
            places = spec.plant.dofs if channel.family in MOTION else spec.actuator.names  # type: ignore[union-attr]
            reading = getattr(motion, channel.family)[..., places.index(channel.place)]
            if inputs is not None:
                lagging = lagged(inputs.fine.time, reading, lag) if lag else reading[:, 0]
                reading = lagging[inputs.samples]
            columns.append(sensed(self.evidence.time, reading, some))
        self.budget.charge(steps if spec.actuator else WIRELESS_STEP_COST * steps)
        self._level(columns)
        return np.stack(columns, axis=1)

    def _level(self, columns: list[Floats]) -> None:
        """Give accelerations, and what has a zero of its own in each recording, their offsets."""
        e, seen = self.evidence, self.evidence.stamps_ns.size if self.seen is None else self.seen
        for k, channel in enumerate(e.channels):
            if channel.family == "acceleration" or channel in e.own_zero:
                columns[k] = levelled(columns[k], e.measured[:, k], e.recordings, seen)

    @property
    def _motors_alone(self) -> bool:
        return all(channel.family == "motor" for channel in self.evidence.channels)

    def _moved(self, spec: Spec, windows: Windows, *, between: bool) -> tuple[Motion, int]:
        """Motion, and the steps that it took."""
        if self._motors_alone:
            seen = self._motors_moved(spec)
            nothing = np.empty((len(seen), 0))
            return Motion(nothing, nothing, nothing, nothing, seen), len(seen)
        points, motor, known, fine, course, samples, further = self._inputs(spec)
        n, m = known.shape[2], motor.shape[2]
        time = fine.points_before_jumps if between else self.evidence.time
        seen = course if between else np.ascontiguousarray(course[samples, 0])
        arrays = mechanics(spec, motor[0, 0])
        load = on_columns(arrays, known, hidden_loads(spec, points), further)
        out = np.zeros((time.size, 3 * n + m))
        starts = np.searchsorted(points.time_ns, self.evidence.stamps_ns[windows.start])
        over = windows.length or float(np.ptp(self.evidence.time))
        steps = steps_in(points.time, spec, arrays, over, coarse=self.is_draft)
        sample, seen_motor = time.ravel(), seen.reshape(time.size, m)
        replay = Replay(points.time, steps, motor, load, starts, windows.state, sample, seen_motor)
        replay_mechanics(arrays, replay, out, working(arrays))
        x, v, a, force = np.split(out.reshape(*time.shape, 3 * n + m), [n, 2 * n, 3 * n], axis=-1)
        return Motion(x, v, a, force, seen), worth(spec) * int(steps.sum()) + time.size

    def _motors_moved(self, spec: Spec) -> Floats:
        """Motor positions (s, m) at the samples."""
        e, held = self.evidence, None
        if e.driven_by == "command":
            held = held_motion(spec, e.stamps_ns, e.due_ns + motor_delay(spec), e.commands, self.first)
        if held is not None:
            return held
        inputs = self._inputs(spec)
        return np.ascontiguousarray(inputs.course[inputs.samples, 0])

    def _inputs(self, spec: Spec) -> Inputs:
        """Inputs of a model, but for hidden loads; kept for a few motors."""
        poles = spec.actuator and spec.actuator.motor_poles
        key = repr([e for e in spec.effects if e.block == "motor"]) + repr(poles)
        key += str(self._longest_interval(spec))
        with self._lock:
            kept = self._motors.get(key)
        if kept is None:
            kept = self._new_inputs(spec)
        self._keep(self._motors, key, kept)
        return kept

    def _longest_interval(self, spec: Spec) -> int:
        of_motion = int(GRID_PERIOD_SHARE * self.evidence.period * NS)
        return longest_interval(spec, of_motion, sharp=self.sharp, coarse=self.is_draft)

    @property
    def _quarter_sample_ns(self) -> int:
        """A quarter of a sampling interval, ns, where that is longer than the grid of a wire may be."""
        interval = np.median(np.diff((self.loads or self.evidence).stamps_ns))
        return max(LONGEST_GRID_INTERVAL_NS, int(interval / 4))

    def _grid(self, delay: int, longest: int, *, samples: bool) -> Grid:
        """Grid of the commands, late by `delay` ns, and of the samples or of where free runs begin."""
        e, key = self.evidence, (delay, longest, samples)
        with self._lock:
            kept = self._grids.get(key)
        if kept is None:
            others = e.stamps_ns if samples else self.starts_ns
            kept = grid(np.concatenate([e.due_ns + delay, others]), int(e.stamps_ns[-1]), longest)
        self._keep(self._grids, key, kept)
        return kept

    def _new_inputs(self, spec: Spec) -> Inputs:
        e = self.evidence
        delay = motor_delay(spec)
        due = e.due_ns + delay
        m = e.commands.shape[1] if e.driven_by == "command" else 0
        fine = self._grid(delay, LONGEST_GRID_INTERVAL_NS if m else self._quarter_sample_ns, samples=True)
        points = fine
        if m and not self._motors_alone and not sizes(spec.effects, "motor", "rate"):
            points = self._grid(delay, self._longest_interval(spec), samples=False)
        course = motor = np.zeros((fine.time_ns.size, 3, m))
        if m:
            course = motor = motor_motion(spec, fine.time_ns, due, e.commands, self.first)
        if points is not fine:
            motor = motor_motion(spec, points.time_ns, due, e.commands, self.first)
        samples = np.searchsorted(fine.time_ns, e.stamps_ns)
        return Inputs(points, motor, load_on(points, self.loads or e, self.between), fine, course, samples)


def _key(bare: Spec, windows: Windows) -> str:
    """What tells a model, started in some windows, from others."""
    moved = (bare.plant, bare.actuator, bare.interface, bare.effects)
    return f"{moved!r} {hash((windows.start.tobytes(), windows.state.tobytes()))} "


def _without_sensors(spec: Spec) -> Spec:
    if not any(e.block in SENSORS for e in spec.effects):
        return spec
    return apply(spec, {"effects": [e.name for e in spec.effects if e.block not in SENSORS]})


def effects_on(spec: Spec, channel: Channel) -> list[EffectSpec]:
    """What a spec says that is wrong with the sensor of a channel."""
    return [e for e in spec.effects if e.block == f"sensor.{channel.family}" and e.place == channel.place]
