"""How well models predict data that had no part in any fit or selection."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import DIVERGED_ERROR
from rthm_analysis.diagnosis.criteria.readings import VALUE_STEP
from rthm_analysis.diagnosis.criteria.verdict import STILL_SIGNAL_TO_NOISE
from rthm_analysis.diagnosis.fitting.colour import whitened_from
from rthm_analysis.diagnosis.fitting.fitting import Fitted, bounded
from rthm_analysis.diagnosis.physical.remainder import Remainder, remainder_of
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats
from rthm_core.spec import Spec


@dataclass(frozen=True)
class Simulated:
    """A model's prediction of all channels over the whole recording: (s, k)."""

    fitted: Fitted
    predicted: Floats


def simulate_all(physical: Physical, fitted: Fitted) -> Simulated:
    """Run a fitted model over the whole recording.

    A run over everything begins in the state that the training part gave. Of several runs each begins in a
    state that fits it: what is recorded at their starts alone is too noisy, or too coarse, to begin from.
    """
    return Simulated(fitted, begun_runs(physical, fitted)[1])


def begun_runs(physical: Physical, fitted: Fitted) -> tuple[Windows, Floats]:
    """Runs of a fitted model over the whole recording, where they begin, and what they predict (s, k)."""
    runs, spec = physical.windows, fitted.model.spec
    if runs.is_one:
        runs = physical.fitting.corrected(runs, fitted)
        return runs, physical.experiment.predicted(spec, runs)
    predicted = physical.experiment.predicted(spec, runs)
    if not np.isfinite(predicted).all():
        return runs, predicted
    fitting = _fitted_states(physical, spec, predicted)
    begun = physical.experiment.predicted(spec, fitting)
    return (fitting, begun) if np.isfinite(begun).all() else (runs, predicted)


def _fitted_states(physical: Physical, spec: Spec, predicted: Floats) -> Windows:
    """Runs that begin in states which fit each of them, by one step from where they begin now."""
    runs, measured = physical.windows, physical.evidence.measured
    weight = np.where(np.isfinite(measured), 1.0 / physical.noise.sigma, 0.0)
    left = np.nan_to_num(measured - predicted) * weight
    changes = by_starts(physical.experiment, spec, runs, predicted) * weight[:, :, None]
    if not np.isfinite(changes).all():
        return runs
    ends = np.append(runs.start[1:], measured.shape[0])
    steps = [
        np.linalg.lstsq(changes[a:b].reshape(-1, changes.shape[2]), left[a:b].ravel(), rcond=1e-10)[0]
        for a, b in zip(runs.start, ends, strict=True)
    ]
    return Windows(runs.start, runs.state + np.stack(steps), runs.length)


def by_starts(experiment: Experiment, spec: Spec, runs: Windows, predicted: Floats) -> Floats:
    """What all channels read more, (s, k, q), per unit by which each entry of the states is larger in which
    runs begin.
    """
    size = 1e-3 * (float(np.nanstd(experiment.evidence.measured[:, 0])) or 1.0)
    moved = [experiment.predicted(spec, runs.moved(i, size)) for i in range(runs.state.shape[1])]
    return np.stack([(one - predicted) / size for one in moved], axis=2)


def by_values(experiment: Experiment, model: Model, runs: Windows, predicted: Floats) -> Floats:
    """What all channels read more, (s, k, p), per unit by which each value of a model is larger."""
    values, columns = model.values, []
    for i, one in enumerate(model.parameters):
        size = VALUE_STEP * one.scale
        moved = model.at(values + size * (np.arange(values.size) == i))
        columns.append((experiment.predicted(moved.spec, runs) - predicted) / size)
    return np.stack(columns, axis=2) if columns else np.empty((*predicted.shape, 0))


def over_noise(physical: Physical, columns: Floats) -> Floats:
    """Errors (s, k), or what channels read more, (s, k, q), over the noise; 0 where nothing was measured."""
    beyond = (1,) * (columns.ndim - 2)
    known = np.isfinite(physical.evidence.measured)
    level = physical.noise.level.reshape(-1, *beyond)
    return np.where(known.reshape(*known.shape, *beyond), columns / level, 0.0)


def spread(physical: Physical, channel: int, samples: slice | None = None) -> float:
    """Standard deviation of a signal in some samples, by default the unseen ones; of the whole of it where it
    hardly moves there.
    """
    measured = physical.evidence.measured[:, channel]
    there = float(np.nanstd(measured[samples or slice(physical.train, None)]))
    return (
        there
        if there > STILL_SIGNAL_TO_NOISE * physical.noise.level[channel]
        else max(float(np.nanstd(measured)), 1e-300)
    )


def nrmse(physical: Physical, predicted: Floats, channel: int, samples: slice | None = None) -> float:
    """Error in some samples, by default the unseen ones, over the `spread` of the signal there;
    `DIVERGED_ERROR` at most.
    """
    samples = samples or slice(physical.train, None)
    error = physical.evidence.measured[samples, channel] - predicted[samples, channel]
    if not np.isfinite(predicted[samples, channel]).all():
        return DIVERGED_ERROR
    size = spread(physical, channel, samples)
    return min(float(np.sqrt(np.nanmean(np.square(error)))) / size, DIVERGED_ERROR)


def errors_of(physical: Physical, predicted: Floats) -> Floats:
    """Errors (s, k) over the noise and whitened; NaN where nothing was measured, `DIVERGED_ERROR` at most."""
    measured = physical.evidence.measured
    error = bounded((np.nan_to_num(measured) - predicted) / physical.noise.sigma)
    error = np.where(np.isfinite(measured), error, 0.0)
    white = whitened_from(error, physical.noise.colours, physical.windows.start)
    return np.where(np.isfinite(measured), white, np.nan)


def held_out_squares(physical: Physical, predicted: Floats) -> float:
    """Squared error of all channels on the held-out part, in units of the noise."""
    return float(np.nansum(np.square(errors_of(physical, predicted)[physical.train :])))


def remainders(physical: Physical, predicted: Floats) -> tuple[Remainder, ...]:
    """What is left of each channel."""
    pairs = zip(errors_of(physical, predicted).T, physical.noise.colours, strict=True)
    return tuple(remainder_of(column, physical.train, colour.is_white) for column, colour in pairs)
