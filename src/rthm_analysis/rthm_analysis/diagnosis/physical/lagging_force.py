"""A known force that acts through a lag, where that is all that the retuned model leaves."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    FORCE_LAG_BEGIN_PERIODS,
    FORCE_LAG_DONE_SHARE,
    FORCE_LAG_LEFT_SHARE,
    FORCE_LAG_ROUNDS,
    FORCE_LAG_STEP,
    FORCE_LAG_TRIALS,
)
from rthm_analysis.diagnosis.criteria.verdict import NOISE_FLOOR_RATIO
from rthm_analysis.diagnosis.faults.force_lag import ForceLag
from rthm_analysis.diagnosis.physical.drifting_clocks import least_left, unexplained_of_force
from rthm_analysis.diagnosis.physical.judged import by_starts, by_values, over_noise
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats
from rthm_core.spec import Spec


def lagging_force(physical: Physical) -> ForceLag | None:
    """The lag of the known force with which nothing but noise is left, in the fitted data and in unseen ones;
    None where there is none, or where known kinds explain the recording.

    The values of the retuned model and the states in which runs begin are found with it: they made up for
    some of it.
    """
    found = unexplained_of_force(physical)
    if found is None:
        return None
    (runs, predicted), model, evidence = found, physical.selection.base.model, physical.evidence
    before = over_noise(physical, evidence.measured - predicted)
    lag = ForceLag(FORCE_LAG_BEGIN_PERIODS * evidence.period, np.zeros(evidence.load.shape[1]))
    for taken in range(FORCE_LAG_ROUNDS):
        loaded = physical.experiment.loaded_by(lag.in_step(evidence))
        predicted = loaded.predicted(model.spec, runs)
        left = over_noise(physical, evidence.measured - predicted)
        of_lag = _of_lag(physical, lag, model.spec, runs, predicted)
        starts = by_starts(loaded, model.spec, runs, predicted)
        values = by_values(loaded, model, runs, predicted)
        shapes = over_noise(physical, np.concatenate((of_lag, starts, values), axis=-1))
        change = least_left(shapes[: physical.train], left[: physical.train])
        if not np.isfinite(change).all():
            return None
        ends = np.cumsum([of_lag.shape[-1], starts.shape[-1]])
        by_lag, by_start, by_value = np.split(change, ends)
        rest = left - over_noise(physical, starts) @ by_start
        if taken >= FORCE_LAG_TRIALS and rest.std() > FORCE_LAG_LEFT_SHARE * before.std():
            return None
        constant = float(np.clip(lag.constant + by_lag[0], lag.constant / 3.0, 3.0 * lag.constant))
        if abs(constant - lag.constant) < FORCE_LAG_DONE_SHARE * constant and _is_noise(rest, physical.train):
            return lag
        lag = ForceLag(constant, lag.beyond + by_lag[1:])
        model = model.at(model.values + by_value)
    return None


def _is_noise(rest: Floats, train: int) -> bool:
    """Whether no more than noise is left of the fitted data, and of the unseen ones."""
    return bool(max(rest[:train].std(), rest[train:].std()) < NOISE_FLOOR_RATIO)


def _of_lag(physical: Physical, lag: ForceLag, spec: Spec, runs: Windows, predicted: Floats) -> Floats:
    """What all channels read more, (s, k, 1 + n), per unit by which each number of a lag is larger."""
    evidence = physical.evidence
    sizes = FORCE_LAG_STEP * np.append(lag.constant, np.abs(evidence.load).max(axis=0))
    columns = []
    for i, size in enumerate(sizes):
        if not size:  # nothing acts on this dof
            columns.append(np.zeros_like(predicted))
            continue
        constant, *beyond = lag.numbers + size * (np.arange(sizes.size) == i)
        loaded = physical.experiment.loaded_by(ForceLag(constant, np.array(beyond)).in_step(evidence))
        columns.append((loaded.predicted(spec, runs) - predicted) / size)
    return np.stack(columns, axis=-1)
