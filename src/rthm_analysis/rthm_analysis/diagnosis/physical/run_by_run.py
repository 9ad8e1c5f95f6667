"""A recording beside a model in many free runs, each from the best start: where the model follows the rig."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.physical.judged import by_starts, by_values, over_noise
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Flags, Floats


class RunByRun(NamedTuple):
    """What a model leaves in each of r runs.

    Attributes
    ----------
    samples : list of slice
    left : list of (b, k) array
        Errors of the channels over the noise; 0 where nothing was measured.
    starts, values : list of (b, k, q), (b, k, p) arrays
        What the state in which the run begins, and the values of the model, make of them.
    """

    samples: list[slice]
    left: list[Floats]
    starts: list[Floats]
    values: list[Floats]

    def from_best_starts(self) -> Floats:
        """Reduced chi-squared (r,) of each run from its best start."""
        return np.array([_chi2(*one) for one in zip(self.left, self.starts, strict=True)])

    def from_best_values(self) -> Floats:
        """The same with values of its own for each."""
        both = (np.concatenate(one, axis=-1) for one in zip(self.starts, self.values, strict=True))
        return np.array([_chi2(*one) for one in zip(self.left, both, strict=True)])

    def step(self, kept: Flags) -> Floats:
        """Change of the model's values that leaves least in some of the runs, from the best start of each."""
        rows = np.flatnonzero(kept)
        values = np.vstack([_without(_flat(self.starts[i]), _flat(self.values[i])) for i in rows])
        left = np.concatenate([_without(_flat(self.starts[i]), self.left[i].ravel()) for i in rows])
        return np.asarray(np.linalg.lstsq(values, left, rcond=1e-10)[0])

    def through(self, run: int, gap: slice) -> tuple[float, Floats]:
        """What one run leaves around a gap in it, from the start that is best there: its reduced chi-squared,
        and that of each channel (k,) within the gap.
        """
        kept = np.delete(np.arange(self.left[run].shape[0]), gap)
        left, starts = self.left[run], self.starts[run]
        sizes = np.linalg.lstsq(_flat(starts[kept]), left[kept].ravel(), rcond=1e-10)[0]
        inside = left[gap] - starts[gap] @ sizes
        return _chi2(left[kept], starts[kept]), np.asarray(np.square(inside).mean(axis=0))


def run_by_run(physical: Physical, runs: Windows, values: Floats) -> RunByRun | None:
    """What the retuned model with some values leaves in some runs; None where it diverges."""
    evidence, model = physical.evidence, physical.selection.base.model.at(values)
    experiment = physical.experiment.beginning_at(evidence.stamps_ns[runs.start])
    predicted = experiment.predicted(model.spec, runs)
    left = over_noise(physical, evidence.measured - predicted)
    starts = over_noise(physical, by_starts(experiment, model.spec, runs, predicted))
    moved = over_noise(physical, by_values(experiment, model, runs, predicted))
    if not all(np.isfinite(one).all() for one in (left, starts, moved)):
        return None
    ends = np.append(runs.start[1:], left.shape[0]).tolist()
    samples = [slice(*part) for part in zip(runs.start.tolist(), ends, strict=True)]
    return RunByRun(samples, *([one[part] for part in samples] for one in (left, starts, moved)))


def _flat(shapes: Floats) -> Floats:
    samples, channels, count = shapes.shape
    return np.asarray(shapes.reshape(samples * channels, count))


def _without(shapes: Floats, values: Floats) -> Floats:
    """What shapes (b, q) cannot explain of values (b,) or (b, p)."""
    return np.asarray(values - shapes @ np.linalg.lstsq(shapes, values, rcond=1e-10)[0])


def _chi2(left: Floats, shapes: Floats) -> float:
    """Mean square of what shapes (b, k, q) cannot explain of errors (b, k) over the noise."""
    columns = _flat(shapes)
    free = max(left.size - columns.shape[1], 1)
    return float(np.square(_without(columns, left.ravel())).sum() / free)
