"""The search for the best trial, by predicting what each hypothesis would do in many."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.experiment import (
    BOUNDS_AGAIN_SHARE,
    PREDICTED_MOST_STEPS,
    PRESENT_STEPS_RATIO,
    REFINED_AMPLITUDES,
    REFINED_FREQUENCIES,
)
from rthm_analysis.diagnosis.experiment.bounds import Bounds, bounds_of
from rthm_analysis.diagnosis.experiment.candidates import candidates
from rthm_analysis.diagnosis.experiment.predicting import Predicted, Predictor, step_of
from rthm_analysis.diagnosis.experiment.trials import Trial, plain
from rthm_analysis.diagnosis.fitting.cores import Cores
from rthm_core.spec import HarmonicLoad

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class Told(NamedTuple):
    """How far a trial tells the hypotheses apart, in which signal, and which part of the bounds it uses."""

    trial: Trial
    apart: float
    signal: str
    used: float


class Search:
    """Trials of some hypotheses, and how many simulations they may still cost.

    Parameters
    ----------
    nominal : Spec
    specs : sequence of Spec
        Hypotheses, two at least.
    noise : mapping
        Standard deviation of each measured channel.
    duration : float
        s.
    budget : int
        Simulations; what is seen already counts, too.
    seen : dict, optional
        What the first hypothesis does in trials, for other searches of which it is the first as well.
    """

    def __init__(
        self,
        nominal: Spec,
        specs: Sequence[Spec],
        noise: Mapping[str, float],
        duration: float,
        budget: int,
        seen: dict[str, Predicted] | None = None,
    ) -> None:
        self.nominal, self.noise, self.left = nominal, noise, budget
        self.specs, self.whole, self.step = specs, duration, min(step_of(one) for one in specs)
        self.steps = min(int(np.ceil(duration / self.step)), PREDICTED_MOST_STEPS)
        self.duration = min(duration, self.steps * self.step)
        self.predictors = [Predictor(one, self.duration / self.steps, self.steps) for one in specs]
        self.cores, self.seen = Cores(), seen

    def best(self, present: Trial) -> tuple[Told, float] | None:
        """The trial that tells most, and how far the present one tells; None where there is none."""
        runs = self._present(present)
        bounds = bounds_of(self.nominal, present, runs[0])
        if not bounds.signals or not np.isfinite(bounds.used(runs[0])):
            return None
        told = list(self._all(candidates(self.nominal, bounds, self.duration), bounds))
        if not told:
            return None
        best = max(told, key=_apart)
        for factor in REFINED_FREQUENCIES:
            best = max([best, *self._all(_around(best, factor), bounds)], key=_apart)
        return best, self._apart(runs)[0]

    def _present(self, trial: Trial) -> list[Predicted]:
        """Predictions of the present test to its end, which may be much longer than a planned one."""
        steps = min(int(np.ceil(self.whole / self.step)), PRESENT_STEPS_RATIO * PREDICTED_MOST_STEPS)
        return self._all_predicted([Predictor(one, self.step, steps) for one in self.specs], trial)

    def _run(self, trial: Trial) -> list[Predicted]:
        return self._all_predicted(self.predictors, trial)

    def _all_predicted(self, predictors: Sequence[Predictor], trial: Trial) -> list[Predicted]:
        """What each hypothesis does; the first one as it was seen before."""
        self.left -= len(predictors)
        if self.seen is None:
            return self.cores.each(lambda one: one.predict(trial), predictors)
        key = f"{predictors[0].step!r} {predictors[0].grid.time_ns.size} {trial!r}"
        asked = predictors[1:] if key in self.seen else predictors
        found = self.cores.each(lambda one: one.predict(trial), asked)
        first = self.seen.setdefault(key, found[0])
        return [first, *found[-len(predictors) + 1 :]]

    def _all(self, trials: Iterator[Trial], bounds: Bounds) -> Iterator[Told]:
        return (one for trial in trials for one in self._told(trial, bounds))

    def _told(self, trial: Trial, bounds: Bounds) -> Iterator[Told]:
        """What a trial tells, made smaller once where it goes beyond the bounds; nothing where that fails."""
        for _ in range(2):
            if self.left < len(self.predictors):
                return
            runs = self._run(trial)
            used = max(bounds.used(one) for one in runs)
            if used <= 1.0:
                yield Told(trial, *self._apart(runs), used)
                return
            if not np.isfinite(used):
                return
            trial = trial.scaled(BOUNDS_AGAIN_SHARE / used)

    def _apart(self, runs: list[Predicted]) -> tuple[float, str]:
        """Smallest difference of two predictions in units of the noise, and where it shows most."""
        return min(self._difference(*pair) for pair in combinations(runs, 2))

    def _difference(self, one: Predicted, other: Predicted) -> tuple[float, str]:
        found = [
            (
                float(np.sqrt(np.mean(np.square(one.signals[name] - other.signals[name]))))
                / self.noise[name],
                name,
            )
            for name in one.signals
            if self.noise.get(name, 0.0) > 0.0
        ]
        return max(found, default=(0.0, ""))


def _around(best: Told, factor: float) -> Iterator[Trial]:
    """Trials like the best one: at other frequencies, and larger or smaller."""
    for side, section in best.trial.loads.items():
        if isinstance(section, HarmonicLoad):
            for by in (factor, 1.0 / factor):
                moved = section.model_copy(update={"frequency": plain(by * section.frequency, 3)})
                yield Trial({side: moved}, best.trial.start)
    yield from (
        best.trial.scaled(by) for by in (*REFINED_AMPLITUDES, BOUNDS_AGAIN_SHARE / max(best.used, 0.1))
    )


def _apart(told: Told) -> float:
    return told.apart
