"""Diagnose the motors: their position is measured, and depends on the commands alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import DRIVE_COLOUR_RATIO_TO_WHITE, DRIVE_COLOUR_SHARE_OF_SIGNAL
from rthm_analysis.diagnosis.criteria.search import (
    DRIVE_WORTH_A_FIT,
    GAIN_OF_CHANCE,
    GAIN_PER_PARAMETER,
    NEAR_NOISE_CHI2,
)
from rthm_analysis.diagnosis.criteria.verdict import DRIVE_MOST_EFFECTS, DRIVE_STEPS, NEGLIGIBLE_DELAY_STD
from rthm_analysis.diagnosis.faults.stretches import held_commands
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.limits import Limits, motor_limits
from rthm_analysis.diagnosis.fitting.noise import noise_levels
from rthm_analysis.diagnosis.physical.unrelated import unrelated
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model, Parameter
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.search.drive_starts import drive_starts
from rthm_analysis.diagnosis.search.judging import FittedCandidate, best_of_labels, clear_gain, reduced_chi2
from rthm_analysis.diagnosis.search.screening import ScoredCandidate, best_of_each, screen
from rthm_core.compiled import Floats
from rthm_core.errors import InputError
from rthm_core.spec import Spec

PREFIX = "drive"


@dataclass(frozen=True)
class Drives:
    """What was found in the motors.

    Attributes
    ----------
    rounds : list of list of FittedCandidate
        Effects, best first in each round.
    settled : Spec
        With those that were chosen.
    limits : dict
        Sizes at which other kinds would have been seen.
    left : (s, m) array
        What the settled spec leaves of the motors' positions, over their noise.
    noise : (m,) array
        Of the motors' sensors, m.
    wanders : bool
        Whether that may be coloured noise of their sensors.
    """

    rounds: list[list[FittedCandidate]]
    settled: Spec
    limits: Limits
    left: Floats
    noise: Floats
    wanders: bool

    @property
    def model(self) -> Model:
        """The settled spec, whose effects are open as far as the motors' positions leave them so.

        What the plant does tells them; taken for exact, they would make physics of the rest.
        """
        return Model(self.settled, (*_open_values(self.rounds), *_open_delays(self.rounds)))


def _open_values(rounds: list[list[FittedCandidate]]) -> Iterator[Parameter]:
    """Values that were fitted, with their standard deviations."""
    if rounds:
        fitted = rounds[-1][0].fitted
        stds = np.sqrt(np.maximum(np.diag(fitted.sums.covariance()), 0.0))
        for p, std in zip(fitted.model.parameters, stds.tolist(), strict=True):
            if 0.0 < std < np.inf:
                yield replace(p, scale=std, prior=(p.value, std))


def _open_delays(rounds: list[list[FittedCandidate]]) -> Iterator[Parameter]:
    """Delays of the effects that were added, which the steps of the motors leave open between bounds."""
    for i, tried in enumerate(rounds):
        one, uncertainty = tried[0].start.added, tried[0].start.scales.get("delay", 0.0)
        if one.law.changes == "delay" and uncertainty > NEGLIGIBLE_DELAY_STD:
            value = float(one.parameters["delay"])
            prior = (value, uncertainty / np.sqrt(3.0))
            yield Parameter(
                f"{PREFIX}{i + 1}.delay",
                value,
                uncertainty,
                value - uncertainty,
                value + uncertainty,
                prior,
            )


def choose_drives(evidence: Evidence, spec: Spec, first: Floats) -> Drives:
    """Find what the motors do beside what the spec says.

    Parameters
    ----------
    evidence : Evidence
        Motor positions of the training part.
    spec : Spec
    first : (m,) array
        Command before the test.
    """
    experiment = Experiment(evidence, first)
    rounds: list[list[FittedCandidate]] = []
    limits: Limits = {}
    model = Model(spec, prefix=PREFIX)
    for _ in range(DRIVE_MOST_EFFECTS):
        fitting = fitting_of(experiment, model)
        here = fitting.fit(model)
        limits = limits or motor_limits(fitting, here, GAIN_OF_CHANCE + GAIN_PER_PARAMETER)
        tried = _tried(fitting, model, here)
        if not tried or not _better(tried[0], here):
            break
        left = evidence.measured - experiment.predicted(model.spec, fitting.windows)
        told = reduced_chi2(fitting, tried[0].fitted) < NEAR_NOISE_CHI2
        if not rounds and not told and _wanders(evidence, left, fitting.sigma):
            break
        rounds.append(tried)
        model = tried[0].fitted.model
    return found_in(experiment, rounds, model, limits)


def fitting_of(experiment: Experiment, model: Model) -> Fitting:
    """Fits of the motors' positions, weighed by the noise that a model leaves."""
    runs = _runs(model.spec)
    return Fitting(experiment, runs, _noise(experiment, model.spec, runs), model)


def found_in(
    experiment: Experiment, rounds: list[list[FittedCandidate]], model: Model, limits: Limits
) -> Drives:
    """What was found in the motors, and what a model with it leaves of their positions."""
    runs, evidence = _runs(model.spec), experiment.evidence
    left = evidence.measured - experiment.predicted(model.spec, runs)
    noise = _noise(experiment, model.spec, runs)
    return Drives(rounds, model.spec, limits, left / noise, noise, _wanders(evidence, left, noise))


def _runs(spec: Spec) -> Windows:
    assert spec.plant is not None
    return Windows(np.array([0]), np.zeros((1, 2 * len(spec.plant.dofs))), None)


def _wanders(evidence: Evidence, left: Floats, noise: Floats) -> bool:
    """Whether what a model leaves of the motors (s, m) is coloured noise of their sensors."""
    size = np.nanstd(left, axis=0)
    if np.any(size < DRIVE_COLOUR_RATIO_TO_WHITE * noise):
        return False
    if np.any(size > DRIVE_COLOUR_SHARE_OF_SIGNAL * np.nanstd(evidence.measured, axis=0)):
        return False
    commands = held_commands(evidence)
    return all(unrelated(error, [commands[:, k]]) for k, error in enumerate(left.T))


def _noise(experiment: Experiment, spec: Spec, runs: Windows) -> Floats:
    """Noise of the motor sensors: steps of a mismatch look like it, so what is stated is an upper bound."""
    measured = experiment.evidence.measured
    residual = measured - experiment.predicted(spec, runs)
    found = noise_levels(residual, measured)
    stated = spec.noise.motor
    return np.where(
        (stated > 0.0) & (found > stated), np.maximum(stated, 1e-5 * np.nanstd(measured, axis=0)), found
    )


def _tried(fitting: Fitting, model: Model, here: Fitted) -> list[FittedCandidate]:
    present = {(one.kind, one.place) for one in model.added}
    starts = [s for s in drive_starts(model.spec, fitting) if (s.added.kind, s.added.place) not in present]
    nothing = np.empty((0, here.samples))
    promising = [
        s for s in screen(fitting, here, nothing, starts) if s.gain > DRIVE_WORTH_A_FIT * GAIN_OF_CHANCE
    ]

    def refined(one: ScoredCandidate) -> FittedCandidate | None:
        try:
            fitted = fitting.fit(one.start.added_to(model), None, DRIVE_STEPS)
        except (InputError, np.linalg.LinAlgError):
            return None
        return FittedCandidate.of(one.start, fitted)

    tried = fitting.cores.each_in_parts(refined, best_of_each(promising, 2))
    return best_of_labels([one for one in tried if one is not None])


def _better(new: FittedCandidate, old: Fitted) -> bool:
    more = max(len(new.start.added.parameters), 1)
    return clear_gain(old, new.fitted, GAIN_OF_CHANCE + GAIN_PER_PARAMETER * more)
