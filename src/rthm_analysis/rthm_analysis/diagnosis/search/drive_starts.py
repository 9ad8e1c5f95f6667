"""Starting values of what can be wrong with a motor: seen in its position alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    COMMAND_BINS,
    DRIVE_FLAT_DELAY,
    DRIVE_LONGEST_DELAY,
    DRIVE_SHORTEST_DELAY,
    ROUNDING_FEWEST_STEPS,
    ROUNDING_LINE_TO_RMS,
)
from rthm_analysis.diagnosis.criteria.verdict import NEGLIGIBLE_DELAY_STD
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.starts import InitialGuess, guessed
from rthm_core.clock import NS
from rthm_core.compiled import Floats
from rthm_core.effects.registry import changing, ranked
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec


def drive_starts(spec: Spec, fitting: Fitting) -> Iterator[InitialGuess]:
    """Starts of every kind in every motor.

    Parameters
    ----------
    spec : Spec
    fitting : Fitting
        Of a recording whose channels are motor positions alone.
    """
    evidence = fitting.experiment.evidence
    residual = evidence.measured - fitting.experiment.predicted(spec, fitting.windows)
    for column, channel in enumerate(evidence.channels):
        u, left = np.nan_to_num(evidence.measured[:, column]), np.nan_to_num(residual[:, column])
        scene = MotorScene(spec, fitting, channel.place, u, left)
        for law in ranked("motor"):
            yield from guessed(law, "motor", channel.place, scene)


@dataclass(frozen=True)
class MotorScene:
    """Recorded position of one motor; attributes as of `rthm_core.effects.guess.MotorSignals`.

    `left` (s,) is what a motor as the spec says leaves of it, m.
    """

    spec: Spec
    fitting: Fitting
    place: str
    position: Floats
    left: Floats

    @property
    def speed(self) -> Floats:
        """Between samples, m/s."""
        return np.abs(np.diff(self.position)) / np.diff(self.fitting.experiment.evidence.time)

    def delay(self) -> tuple[float, float]:
        """Delay beside the spec's that fits best, and how far it may be from it without a difference, s."""
        return _best_delay(self.spec, self.fitting, self.place)

    def step(self) -> float | None:
        """Step to which commands are rounded, m; None where none shows."""
        actuator = self.spec.actuator.names.index(self.place) if self.spec.actuator else 0
        return _step(self.fitting.experiment.evidence, actuator, self.left)


def _best_delay(spec: Spec, fitting: Fitting, name: str) -> tuple[float, float]:
    """Delay with the smallest squared error, and how much longer or shorter it may be without any difference.

    The best of a row is looked for, then of ever finer rows around it. Motors that follow at once move in
    steps, and between two samples it makes no difference when. A motor can answer earlier than the spec says
    by no more than commands are under way. Zero: the delay of the spec does as well as any.
    """
    experiment = fitting.experiment
    schedule = Schedule(spec)
    specified = (schedule.links["tau4"].delay_ns + schedule.motor_delay) / NS
    earliest = -min(experiment.evidence.under_way, specified)

    def error(delay: float) -> float:
        if delay < earliest:
            return np.inf
        model = Model(spec, prefix="trial").plus(
            EffectInstance("motor", changing("motor", "delay").kind, name, {"delay": delay}), (), {}
        )
        left = experiment.evidence.measured - experiment.predicted(model.spec, fitting.windows)
        return float(np.nansum(np.square(left)))

    def best_of(row: Floats) -> float:
        return float(row[int(np.argmin(fitting.cores.each(error, row.tolist())))])

    earlier = (
        -np.geomspace(DRIVE_SHORTEST_DELAY, -earliest, 8) if -earliest > DRIVE_SHORTEST_DELAY else np.empty(0)
    )
    later = np.concatenate([np.linspace(0.0, 0.012, 13), np.geomspace(0.016, DRIVE_LONGEST_DELAY, 7)])
    best = best_of(np.concatenate([later, earlier]))
    if best == 0.0 and min(error(DRIVE_SHORTEST_DELAY), error(-DRIVE_SHORTEST_DELAY)) >= error(0.0):
        return 0.0, 0.0
    width = max(0.001, 0.3 * abs(best))
    # Commands come in steps, so that a delay that is off by a microsecond already shows.
    for _ in range(7):
        best = best_of(best + width * np.linspace(-1.0, 1.0, 9))
        width *= 0.25
    low, high = (_edge(error, best, best + side * DRIVE_FLAT_DELAY) for side in (-1.0, 1.0))
    if low <= 0.0 <= high:
        return 0.0, 0.0
    return 0.5 * (low + high), max(0.5 * (high - low), NEGLIGIBLE_DELAY_STD)


def _edge(error: Callable[[float], float], inside: float, outside: float) -> float:
    """How far from `inside` towards `outside` the error stays what it is."""
    least = error(inside) * (1.0 + 1e-9)
    if error(outside) <= least:
        return outside
    while abs(outside - inside) > 1e-7:
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if error(middle) <= least else (inside, middle)
    return inside


def _step(evidence: Evidence, actuator: int, residual: Floats) -> float | None:
    """Step to which commands are rounded: the period of the residual over the command.

    The rounding error is a saw tooth of the command. The residual, sorted into fine bins of the command, has
    a line in its spectrum there.
    """
    commands = evidence.commands[:, actuator]
    row = np.searchsorted(evidence.due_ns, evidence.stamps_ns[: residual.size], side="right") - 1
    known = row >= 0
    command = commands[row[known]]
    low, high = float(command.min()), float(command.max())
    if high - low <= 0.0:
        return None
    place = ((command - low) / (high - low) * (COMMAND_BINS - 1)).astype(int)
    total = np.bincount(place, weights=residual[known] - residual[known].mean(), minlength=COMMAND_BINS)
    spectrum = np.abs(np.fft.rfft(total))[1 : COMMAND_BINS // 3]
    best = int(np.argmax(spectrum)) + 1
    if best < ROUNDING_FEWEST_STEPS or spectrum[best - 1] < ROUNDING_LINE_TO_RMS * np.sqrt(
        np.mean(np.square(spectrum))
    ):
        return None
    return _sharpened((high - low) / best, command, residual[known])


def _sharpened(step: float, command: Floats, residual: Floats) -> float:
    """Best step near a first guess: the one whose rounding error fits the residual best."""
    span = float(np.abs(command).max())
    width = step * step / span
    for _ in range(4):
        row = step + width * np.linspace(-1.0, 1.0, 41)
        errors = [np.sum(np.square(residual - (s * np.floor(command / s + 0.5) - command))) for s in row]
        step = float(row[int(np.argmin(errors))])
        width /= 10.0
    return step
