"""What a hypothesis predicts of a trial, signal by signal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.experiment import PREDICTED_STEP_RADIANS, PREDICTED_STEP_TO_FILTER
from rthm_analysis.diagnosis.experiment.closed import closed_loop, fastest_motion, loaded
from rthm_analysis.diagnosis.experiment.trials import Trial
from rthm_analysis.diagnosis.replay.evidence import Channel
from rthm_analysis.diagnosis.replay.grid import Grid
from rthm_analysis.diagnosis.replay.kernel import Replay, replay_mechanics, working
from rthm_analysis.diagnosis.replay.loads import hidden_loads, on_columns
from rthm_analysis.diagnosis.replay.mechanics import state_matrix
from rthm_core.clock import NS
from rthm_core.compiled import Floats
from rthm_core.loads import load

if TYPE_CHECKING:
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Predicted:
    """Motion in a trial.

    Attributes
    ----------
    signals : dict of (s,) arrays
        By the names of the recording's channels: x1, v1, F.
    command : (s, m) array
        u_d, m.
    """

    signals: dict[str, Floats]
    families: dict[str, str]
    command: Floats
    step: float

    @property
    def time(self) -> Floats:
        """Instants of the signals, s."""
        return np.asarray(np.arange(next(iter(self.signals.values())).size) * self.step, dtype=float)

    def largest(self, family: str) -> float:
        """Largest size of the signals of a family: position, velocity, force, command, rate."""
        if family in ("command", "rate"):
            moved = self.command if family == "command" else np.diff(self.command, axis=0) / self.step
            return float(np.abs(moved).max(initial=0.0))
        columns = [self.signals[name] for name, one in self.families.items() if one == family]
        return max((float(np.abs(one).max(initial=0.0)) for one in columns), default=0.0)


class Predictor:
    """One hypothesis, ready to be tried with many inputs.

    Parameters
    ----------
    spec : Spec
        Loop, or plant alone.
    step : float
        Of the predictions, s.
    steps : int
    """

    def __init__(self, spec: Spec, step: float, steps: int) -> None:
        assert spec.plant is not None
        self.spec, self.step = spec, step
        self.closed = closed_loop(spec)
        self.grid = Grid(np.arange(steps + 1, dtype=np.int64) * round(step * NS))
        self.hidden = hidden_loads(spec, self.grid)
        self.channels = [
            *(Channel("position", dof) for dof in spec.plant.dofs),
            *(Channel("velocity", dof) for dof in spec.plant.dofs),
            *(Channel("acceleration", dof) for dof in spec.plant.dofs),
            *(Channel("force", name) for name in (spec.actuator.names if spec.actuator else ())),
        ]

    @np.errstate(over="ignore", invalid="ignore")  # what runs away is seen by its size
    def predict(self, trial: Trial) -> Predicted:
        """Motion of the hypothesis in a trial."""
        section = trial.loads.get("numerical")
        numerical = None if section is None or section.kind == "none" else section.dof
        arrays, points = loaded(self.closed, self.spec, numerical), self.grid.points
        n, m = arrays.n, arrays.m
        motor, forces = np.zeros((*points.shape, m)), self._load(trial, points)
        if numerical is not None and m:
            motor[:, :, 0] = load(section).force(points)
        start = arrays._replace(initial=trial.start * arrays.initial)
        out = np.zeros((points.shape[0], 3 * n + m))
        first, state = np.zeros(1, dtype=np.int64), np.ascontiguousarray(start.initial[None, : 2 * n])
        no_motor = np.zeros((points.shape[0], m))
        once = np.ones(points.shape[0], dtype=np.int64)
        replay = Replay(self.grid.time, once, motor, forces, first, state, self.grid.time, no_motor)
        replay_mechanics(start, replay, out, working(start))
        return self._named(out, n)

    def _load(self, trial: Trial, points: Floats) -> Floats:
        assert self.spec.plant is not None
        dofs = self.spec.plant.dofs
        total = np.zeros((*points.shape, len(dofs)))
        section = trial.loads.get("plant")
        if section is not None and section.kind != "none":
            total[:, :, dofs.index(section.dof)] += load(section).force(points)
        if trial.recorded is not None:
            time, forces = trial.recorded
            for i, column in enumerate(forces.T):
                total[:, :, i] += np.interp(points, time, column)
        return on_columns(self.closed, total, self.hidden)

    def _named(self, out: Floats, n: int) -> Predicted:
        signals = {one.signal: out[:, i] for i, one in enumerate(self.channels)}
        families = {one.signal: one.family for one in self.channels}
        return Predicted(signals, families, self._command(out, n), self.step)

    def _command(self, out: Floats, n: int) -> Floats:
        if not self.spec.is_loop:
            return np.empty((out.shape[0], 0))
        loop = self.spec.loop()
        places = [loop.plant.dofs.index(dof) for dof in loop.interface.plant_dof]
        return np.asarray(out[:, places] + out[:, 3 * n :] / np.array(self.spec.k_tot))


def step_of(spec: Spec) -> float:
    """Step, s, that a hypothesis needs: short for its motion, and no longer than its filters bear."""
    rates = np.abs(np.linalg.eigvals(state_matrix(closed_loop(spec))))
    return min(PREDICTED_STEP_RADIANS / fastest_motion(spec), PREDICTED_STEP_TO_FILTER / float(rates.max()))
