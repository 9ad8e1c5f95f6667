"""A motion that comes later and later after the known force, or earlier: two clocks that drift apart."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    DRIFTING_DONE_SAMPLES,
    DRIFTING_ROUNDS,
    DRIFTING_SHARE,
    DRIFTING_TRIALS,
)
from rthm_analysis.diagnosis.criteria.signals import CLOCK_DRIFT_LEAST_SAMPLES
from rthm_analysis.diagnosis.criteria.verdict import NOISE_FLOOR_RATIO
from rthm_analysis.diagnosis.faults.drift import Drift
from rthm_analysis.diagnosis.physical.judged import begun_runs, by_starts, by_values, over_noise
from rthm_analysis.diagnosis.physical.leaves_noise import explained_by_kinds
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats


def drifting_clocks(physical: Physical) -> Drift | None:
    """The delay between known force and motion, where it grows and is all that the model leaves, in the
    fitted data and in unseen ones; None where it is not, or where known kinds explain the recording.
    """
    found = unexplained_of_force(physical)
    return None if found is None else _drift(physical, *found)


def unexplained_of_force(physical: Physical) -> tuple[Windows, Floats] | None:
    """Runs of the retuned model under a known force, each from its best start, and what they predict; None
    where nothing is left of the recording, or where known kinds explain it.
    """
    evidence = physical.evidence
    if evidence.driven_by != "force" or len(evidence.recordings) > 1 or not np.any(evidence.load):
        return None
    if explained_by_kinds(physical.fitting, physical.selection):
        return None
    runs, predicted = begun_runs(physical, physical.selection.base)
    left = over_noise(physical, evidence.measured - predicted)
    if not np.isfinite(left).all() or left[: physical.train].std() < NOISE_FLOOR_RATIO:
        return None
    return runs, predicted


def _drift(physical: Physical, runs: Windows, predicted: Floats) -> Drift | None:
    """The delay that leaves least, with the state that the recording then begins in, and the values that the
    delay had moved, if it is enough.
    """
    model, evidence, train = physical.selection.base.model, physical.evidence, physical.train
    left = rest = over_noise(physical, evidence.measured - predicted)
    starts = over_noise(physical, by_starts(physical.experiment, model.spec, runs, predicted))
    step, end = float(np.median(np.diff(evidence.time))), float(evidence.time[-1])
    sizes, moved = np.zeros(2 + starts.shape[-1]), model.values
    loaded = physical.experiment
    for taken in range(DRIFTING_ROUNDS):
        values = over_noise(physical, by_values(loaded, model.at(moved), runs, predicted))
        shapes = np.concatenate([_of_delay(physical, predicted), starts, values], axis=-1)
        every = least_left(shapes[:train], rest[:train])
        if not np.isfinite(every).all():
            return None
        change, values_change = np.split(every, [sizes.size])
        sizes, moved = sizes + change, model.at(moved + values_change).values
        drift = Drift(float(sizes[0]), float(sizes[1]))
        loaded = physical.experiment.loaded_by(drift.corrected(evidence).load)
        predicted = loaded.predicted(model.at(moved).spec, runs)
        beside = starts @ sizes[2:]
        rest = over_noise(physical, evidence.measured - predicted) - beside
        share = min(_shares(left - beside, rest, train))
        if not np.isfinite(share) or (share < DRIFTING_SHARE / 2.0 and taken >= DRIFTING_TRIALS):
            return None
        if abs(change[0]) + abs(change[1]) * end < DRIFTING_DONE_SAMPLES * step:
            break
    grows = abs(drift.growth) * end > CLOCK_DRIFT_LEAST_SAMPLES * step
    return drift if grows and share > DRIFTING_SHARE else None


def _of_delay(physical: Physical, predicted: Floats) -> Floats:
    """What a delay of a second, and one that grows by a second per second, make of errors: (s, k, 2)."""
    time = physical.evidence.time
    late = -np.gradient(predicted, time, axis=0)
    return over_noise(physical, np.stack([late, late * time[:, None]], axis=-1))


def least_left(shapes: Floats, left: Floats) -> Floats:
    """Sizes of shapes (s, k, q) that leave least of errors (s, k); NaN where a simulation has diverged."""
    if not (np.isfinite(shapes).all() and np.isfinite(left).all()):
        return np.full(shapes.shape[-1], np.nan)
    return np.asarray(np.linalg.lstsq(shapes.reshape(left.size, -1), left.ravel(), rcond=None)[0])


def _shares(whole: Floats, rest: Floats, train: int) -> list[float]:
    """Part of errors that is gone, of those that fits have seen and of the others."""
    parts = (slice(train), slice(train, None))
    return [1.0 - float(np.sum(rest[part] ** 2) / np.sum(whole[part] ** 2)) for part in parts]
