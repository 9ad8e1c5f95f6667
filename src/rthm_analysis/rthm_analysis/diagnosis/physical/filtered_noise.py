"""Noise of a sensor that lags and passes its filter with what it measures: it is slow, and no physics."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import FILTERED_RMS_RATIO
from rthm_analysis.diagnosis.fitting.colour import Colour
from rthm_analysis.diagnosis.fitting.noise import Noise
from rthm_analysis.diagnosis.physical.beginning import Baseline, with_noise
from rthm_analysis.diagnosis.physical.colours import left_by
from rthm_analysis.diagnosis.physical.explaining import fitted_again
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.physical.remainder import slow_power, tolerance
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.readings import noise_level
from rthm_analysis.diagnosis.search.judging import Selection
from rthm_core.compiled import Floats


def with_filtered_noise(begun: Baseline, selection: Selection) -> tuple[Baseline, Selection] | None:
    """The same effects judged by noise that has passed the lags of the sensors that were found, where nothing
    else is then left; None where there is more, or no such lag.
    """
    lags = _lags(selection.best.model)
    if not lags or at_noise(begun.fitting, selection.best):
        return None
    evidence, left = begun.fitting.experiment.evidence, left_by(begun.fitting, selection.best)
    step = float(np.median(np.diff(evidence.time)))
    colours = list(begun.noise.colours)
    for k, channel in enumerate(evidence.channels):
        if (lag := lags.get((f"sensor.{channel.family}", channel.place))) is not None:
            pole = float(np.exp(-step / lag))
            colours[k] = _passed(left[:, k], evidence.measured[:, k], pole) or colours[k]
    if colours == list(begun.noise.colours):
        return None
    filtered = with_noise(begun, Noise(tuple(colours)))
    again = fitted_again(filtered, selection)
    return again if again is not None and at_noise(filtered.fitting, again[1].best) else None


def _lags(model: Model) -> dict[tuple[str, str], float]:
    """Time constants, s, of the sensors that a model makes lag, by block and place."""
    found = {}
    for index, one in enumerate(model.added):
        if one.block.startswith("sensor.") and one.law.changes == "smoothing":
            (value,) = (v for v in model.effect_values(index).values() if not isinstance(v, str))
            found[one.block, one.place] = float(value)
    return found


def _passed(error: Floats, measured: Floats, pole: float) -> Colour | None:
    """Colour of white noise behind a filter of this pole, where an error (s,) is that."""
    before = error[1:] - pole * error[:-1]
    level = noise_level(before, measured)
    white = before[np.isfinite(before)] / level
    if np.sqrt(np.mean(white**2)) > FILTERED_RMS_RATIO or slow_power(white)[0] > tolerance(white=True):
        return None
    return Colour(pole, 0.0, level, level / float(np.sqrt(1.0 - pole**2)))
