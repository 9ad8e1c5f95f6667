"""How well models predict data that had no part in any fit or choice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Simulated:
    """A model's prediction of all channels over the whole recording: (s, k)."""

    fitted: Fitted
    predicted: Floats


def simulate_all(physical: Physical, fitted: Fitted) -> Simulated:
    """Run a fitted model over the whole recording, from initial states that the training part gave."""
    correction = physical.fitting.state_correction(fitted)
    runs = physical.windows
    for column, by in enumerate(correction):
        runs = runs.moved(column, float(by))
    return Simulated(fitted, physical.experiment.predicted(fitted.model.spec, runs))


def nrmse(physical: Physical, predicted: Floats, channel: int) -> float:
    """Error on the held-out part over the signal's standard deviation there."""
    held = slice(physical.train, None)
    measured = physical.evidence.measured[held, channel]
    error = measured - predicted[held, channel]
    return float(np.sqrt(np.nanmean(np.square(error))) / max(float(np.nanstd(measured)), 1e-300))


def held_out_squares(physical: Physical, predicted: Floats) -> float:
    """Squared error of all channels on the held-out part, in units of the noise."""
    held = slice(physical.train, None)
    error = (physical.evidence.measured - predicted)[held] / physical.sigma
    return float(np.nansum(np.square(error)))


def coloured(residual: Floats, samples: int = 16) -> float:
    """Power of slow residuals over that of white noise with the same standard deviation 1; 1: white.

    Parameters
    ----------
    residual : (s,) array
        In units of the noise.
    samples : int
        Length of the averages in which noise drowns and physics does not.
    """
    count = residual.size // samples * samples
    averages = np.nanmean(residual[:count].reshape(-1, samples), axis=1)
    return float(np.nanmean(np.square(averages)) * samples)
