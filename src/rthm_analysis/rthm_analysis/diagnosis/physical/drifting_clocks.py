"""A motion that comes later and later after the known force, or earlier: two clocks that drift apart."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    DRIFTING_DONE_SAMPLES,
    DRIFTING_ROUNDS,
    DRIFTING_SHARE,
)
from rthm_analysis.diagnosis.criteria.signals import CLOCK_DRIFT_LEAST_SAMPLES
from rthm_analysis.diagnosis.criteria.verdict import NOISE_FLOOR_RATIO
from rthm_analysis.diagnosis.faults.drift import Drift
from rthm_analysis.diagnosis.physical.judged import begun_runs, by_starts
from rthm_analysis.diagnosis.physical.leaves_noise import explained_by_kinds
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats


def drifting_clocks(physical: Physical) -> Drift | None:
    """The delay between known force and motion, where it grows and is all that the model leaves, in the
    fitted data and in unseen ones; None where it is not, or where known kinds explain the recording.
    """
    evidence = physical.evidence
    if evidence.driven_by != "force" or len(evidence.recordings) > 1 or not np.any(evidence.load):
        return None
    if explained_by_kinds(physical.fitting, physical.selection):
        return None
    runs, predicted = begun_runs(physical, physical.selection.base)
    left = _left(physical, predicted)
    if not np.isfinite(left).all() or left[: physical.train].std() < NOISE_FLOOR_RATIO:
        return None
    return _drift(physical, runs, predicted)


def _drift(physical: Physical, runs: Windows, predicted: Floats) -> Drift | None:
    """The delay that leaves least, with the state that the recording then begins in, if it is enough."""
    spec, evidence, train = physical.selection.base.model.spec, physical.evidence, physical.train
    left = rest = _left(physical, predicted)
    starts = by_starts(physical, spec, runs, predicted) / physical.noise.level[:, None]
    starts = np.where(np.isfinite(evidence.measured)[:, :, None], starts, 0.0)
    step, end = float(np.median(np.diff(evidence.time))), float(evidence.time[-1])
    sizes = np.zeros(2 + starts.shape[-1])
    for _ in range(DRIFTING_ROUNDS):
        shapes = np.concatenate([_of_delay(physical, predicted), starts], axis=-1)
        change = _least(shapes[:train], rest[:train])
        sizes = sizes + change
        drift = Drift(float(sizes[0]), float(sizes[1]))
        predicted = physical.experiment.loaded_by(drift.in_step(evidence)).predicted(spec, runs)
        beside = starts @ sizes[2:]
        rest = _left(physical, predicted) - beside
        share = min(_shares(left - beside, rest, train))
        if share < DRIFTING_SHARE / 2.0:
            return None
        if abs(change[0]) + abs(change[1]) * end < DRIFTING_DONE_SAMPLES * step:
            break
    grows = abs(drift.growth) * end > CLOCK_DRIFT_LEAST_SAMPLES * step
    return drift if grows and share > DRIFTING_SHARE else None


def _left(physical: Physical, predicted: Floats) -> Floats:
    """Errors (s, k) over the noise; 0 where nothing was measured."""
    error = (physical.evidence.measured - predicted) / physical.noise.level
    return np.where(np.isfinite(physical.evidence.measured), error, 0.0)


def _of_delay(physical: Physical, predicted: Floats) -> Floats:
    """What a delay of a second, and one that grows by a second per second, make of errors: (s, k, 2)."""
    time = physical.evidence.time
    late = -np.gradient(predicted, time, axis=0) / physical.noise.level
    late = np.where(np.isfinite(physical.evidence.measured), late, 0.0)
    return np.stack([late, late * time[:, None]], axis=-1)


def _least(shapes: Floats, left: Floats) -> Floats:
    """Sizes of shapes (s, k, q) that leave least of errors (s, k)."""
    return np.asarray(np.linalg.lstsq(shapes.reshape(left.size, -1), left.ravel(), rcond=None)[0])


def _shares(whole: Floats, rest: Floats, train: int) -> list[float]:
    """Part of errors that is gone, of those that fits have seen and of the others."""
    parts = (slice(train), slice(train, None))
    return [1.0 - float(np.sum(rest[part] ** 2) / np.sum(whole[part] ** 2)) for part in parts]
