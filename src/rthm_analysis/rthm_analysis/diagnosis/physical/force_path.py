"""How a known force reaches the plant, where that is all that the retuned model leaves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    FORCE_PATH_DONE_SHARE,
    FORCE_PATH_LEFT_SHARE,
    FORCE_PATH_ROUNDS,
    FORCE_PATH_TRIALS,
)
from rthm_analysis.diagnosis.criteria.verdict import NOISE_FLOOR_RATIO
from rthm_analysis.diagnosis.faults.force_path import ForceLag, ForceLeak, ForcePath
from rthm_analysis.diagnosis.physical.drifting_clocks import least_left, unexplained_of_force
from rthm_analysis.diagnosis.physical.judged import by_starts, by_values, over_noise
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats
from rthm_core.spec import Spec


def force_path(physical: Physical) -> ForcePath | None:
    """The way of the known force with which nothing but noise is left, in the fitted data and in unseen ones;
    None where there is none, or where known kinds explain the recording.

    The values of the retuned model and the states in which runs begin are found with it: they made up for
    some of it.
    """
    found = unexplained_of_force(physical)
    if found is None:
        return None
    fitted = (_fitted(physical, one, *found) for one in _begun(physical))
    return next((one for one in fitted if one is not None), None)


def _begun(physical: Physical) -> Iterator[ForcePath]:
    """Ways of a force to begin with."""
    yield ForceLag.begun(physical.evidence)
    assert physical.spec.plant is not None
    if len(physical.spec.plant.dofs) > 1:
        yield ForceLeak.begun(physical.evidence, tuple(physical.spec.plant.dofs))


def _fitted(physical: Physical, path: ForcePath, runs: Windows, predicted: Floats) -> ForcePath | None:
    """A way of the force by steps of Gauss and Newton, if it leaves noise."""
    model, evidence = physical.selection.base.model, physical.evidence
    before = over_noise(physical, evidence.measured - predicted)
    for taken in range(FORCE_PATH_ROUNDS):
        loaded = physical.experiment.loaded_by(path.in_step(evidence))
        predicted = loaded.predicted(model.spec, runs)
        left = over_noise(physical, evidence.measured - predicted)
        of_path = _of_path(physical, path, model.spec, runs, predicted)
        starts = by_starts(loaded, model.spec, runs, predicted)
        values = by_values(loaded, model, runs, predicted)
        shapes = over_noise(physical, np.concatenate((of_path, starts, values), axis=-1))
        change = least_left(shapes[: physical.train], left[: physical.train])
        if not np.isfinite(change).all():
            return None
        ends = np.cumsum([of_path.shape[-1], starts.shape[-1]])
        by_path, by_start, by_value = np.split(change, ends)
        rest = left - over_noise(physical, starts) @ by_start
        if taken >= FORCE_PATH_TRIALS and rest.std() > FORCE_PATH_LEFT_SHARE * before.std():
            return None
        moved = path.at(path.numbers + by_path)
        if _is_done(path, moved) and _is_noise(rest, physical.train):
            return path
        path, model = moved, model.at(model.values + by_value)
    return None


def _is_done(path: ForcePath, moved: ForcePath) -> bool:
    """Whether a step hardly moves what is told of a way."""
    return float(np.abs(moved.told - path.told).max()) < FORCE_PATH_DONE_SHARE * float(
        np.abs(moved.told).max()
    )


def _is_noise(rest: Floats, train: int) -> bool:
    """Whether no more than noise is left of the fitted data, and of the unseen ones."""
    return bool(max(rest[:train].std(), rest[train:].std()) < NOISE_FLOOR_RATIO)


def _of_path(physical: Physical, path: ForcePath, spec: Spec, runs: Windows, predicted: Floats) -> Floats:
    """What all channels read more, (s, k, q), per unit by which each number of a way is larger."""
    evidence, columns = physical.evidence, []
    sizes = path.steps(evidence)
    for i, size in enumerate(sizes):
        if not size:
            columns.append(np.zeros_like(predicted))
            continue
        moved = path.at(path.numbers + size * (np.arange(sizes.size) == i))
        loaded = physical.experiment.loaded_by(moved.in_step(evidence))
        columns.append((loaded.predicted(spec, runs) - predicted) / size)
    return np.stack(columns, axis=-1)
