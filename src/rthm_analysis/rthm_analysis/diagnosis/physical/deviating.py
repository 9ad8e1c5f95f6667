"""What is wrong with a whole recording, where that is all that the retuned model leaves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    DEVIATION_DONE_SHARE,
    DEVIATION_LEFT_SHARE,
    DEVIATION_ROUNDS,
    DEVIATION_TRIALS,
)
from rthm_analysis.diagnosis.criteria.verdict import NOISE_FLOOR_RATIO
from rthm_analysis.diagnosis.faults.deviations import Deviation
from rthm_analysis.diagnosis.faults.force_lag import ForceLag
from rthm_analysis.diagnosis.faults.leaks import Crosstalk, ForceLeak
from rthm_analysis.diagnosis.physical.drifting_clocks import least_left, unexplained_of_force
from rthm_analysis.diagnosis.physical.judged import by_starts, by_values, over_noise
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats
from rthm_core.spec import Spec


def deviation(physical: Physical) -> Deviation | None:
    """What a recording under a known force deviates by, with which nothing but noise is left, in the fitted
    data and in unseen ones; None where there is none, or where known kinds explain the recording.

    The values of the retuned model and the states in which runs begin are found with it: they made up for
    some of it.
    """
    found = unexplained_of_force(physical)
    if found is None:
        return None
    fitted = (_fitted(physical, one, *found) for one in _begun(physical))
    return next((one for one in fitted if one is not None), None)


def _begun(physical: Physical) -> Iterator[Deviation]:
    """Deviations to begin with."""
    evidence, plant = physical.evidence, physical.spec.plant
    assert plant is not None
    yield ForceLag.begun(evidence)
    yield from (one for one in (ForceLeak.of(evidence, plant.dofs), Crosstalk.of(evidence)) if one.pairs)


def _fitted(physical: Physical, one: Deviation, runs: Windows, predicted: Floats) -> Deviation | None:
    """A deviation by steps of Gauss and Newton, if without it noise is left."""
    model, evidence = physical.selection.base.model, physical.evidence
    before = over_noise(physical, evidence.measured - predicted)
    for taken in range(DEVIATION_ROUNDS):
        loaded, predicted, left = _without(physical, one, model.spec, runs)
        by_numbers = _by_numbers(physical, one, model.spec, runs, left)
        starts = over_noise(physical, by_starts(loaded, model.spec, runs, predicted))
        values = over_noise(physical, by_values(loaded, model, runs, predicted))
        shapes = np.concatenate((by_numbers, starts, values), axis=-1)
        change = least_left(shapes[: physical.train], left[: physical.train])
        if not np.isfinite(change).all():
            return None
        ends = np.cumsum([by_numbers.shape[-1], starts.shape[-1]])
        step, by_start, by_value = np.split(change, ends)
        rest = left - starts @ by_start
        if taken >= DEVIATION_TRIALS and rest.std() > DEVIATION_LEFT_SHARE * before.std():
            return None
        moved = one.at(one.numbers + step)
        if _is_done(one, moved) and _is_noise(rest, physical.train):
            return one
        one, model = moved, model.at(model.values + by_value)
    return None


def _is_done(one: Deviation, moved: Deviation) -> bool:
    """Whether a step hardly moves what is told of a deviation."""
    largest = float(np.abs(moved.told).max())
    return float(np.abs(moved.told - one.told).max()) < DEVIATION_DONE_SHARE * largest


def _is_noise(rest: Floats, train: int) -> bool:
    """Whether no more than noise is left of the fitted data, and of the unseen ones."""
    return bool(max(rest[:train].std(), rest[train:].std()) < NOISE_FLOOR_RATIO)


def _without(
    physical: Physical, one: Deviation, spec: Spec, runs: Windows
) -> tuple[Experiment, Floats, Floats]:
    """A test without a deviation, what a model predicts of it (s, k), and its errors over the noise."""
    evidence = one.corrected(physical.evidence)
    loaded = physical.experiment.loaded_by(evidence.load)
    predicted = loaded.predicted(spec, runs)
    return loaded, predicted, over_noise(physical, evidence.measured - predicted)


def _by_numbers(physical: Physical, one: Deviation, spec: Spec, runs: Windows, left: Floats) -> Floats:
    """By how much less is left of all channels, (s, k, q), per unit by which each number of a deviation is
    larger.
    """
    columns, sizes = [], one.steps(physical.evidence)
    for i, size in enumerate(sizes):
        if size:
            moved = one.at(one.numbers + size * (np.arange(sizes.size) == i))
            columns.append((left - _without(physical, moved, spec, runs)[2]) / size)
        else:
            columns.append(np.zeros_like(left))
    return np.stack(columns, axis=-1)
