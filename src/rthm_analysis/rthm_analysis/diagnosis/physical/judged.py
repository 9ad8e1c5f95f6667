"""How well models predict data that had no part in any fit or choice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.fitting.colour import whitened_from
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.physical.remainder import COLOURED, SLOW, Remainder, remainder_of
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_core.compiled import Floats

STILL = 3.0
"""Standard deviation of a signal, over its noise, below which it stands still."""


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


def spread(physical: Physical, channel: int) -> float:
    """Standard deviation of a signal on the unseen part; of the whole of it where it hardly moves there."""
    measured = physical.evidence.measured[:, channel]
    held = float(np.nanstd(measured[physical.train :]))
    return held if held > STILL * physical.noise.level[channel] else max(float(np.nanstd(measured)), 1e-300)


def nrmse(physical: Physical, predicted: Floats, channel: int) -> float:
    """Error on the held-out part over the `spread` of the signal."""
    held = slice(physical.train, None)
    error = physical.evidence.measured[held, channel] - predicted[held, channel]
    return float(np.sqrt(np.nanmean(np.square(error)))) / spread(physical, channel)


def errors_of(physical: Physical, predicted: Floats) -> Floats:
    """Errors (s, k) over the noise and whitened; NaN where nothing was measured."""
    error = (physical.evidence.measured - predicted) / physical.noise.sigma
    white = whitened_from(np.nan_to_num(error), physical.noise.colours, physical.windows.start)
    return np.where(np.isfinite(error), white, np.nan)


def held_out_squares(physical: Physical, predicted: Floats) -> float:
    """Squared error of all channels on the held-out part, in units of the noise."""
    return float(np.nansum(np.square(errors_of(physical, predicted)[physical.train :])))


def remainders(physical: Physical, predicted: Floats) -> tuple[Remainder, ...]:
    """What is left of each channel."""
    pairs = zip(errors_of(physical, predicted).T, physical.noise.colours, strict=True)
    return tuple(
        remainder_of(column, physical.train, SLOW if colour.is_white else COLOURED)
        for column, colour in pairs
    )
