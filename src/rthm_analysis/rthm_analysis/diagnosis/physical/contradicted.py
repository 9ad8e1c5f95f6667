"""Errors of one channel that another channel of the same dof denies: no motion made them."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.physical.judged import errors_of
from rthm_analysis.diagnosis.physical.remainder import SAMPLES, Remainder
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_core.compiled import Floats

PARTNER = {"position": "velocity", "velocity": "position"}

LOUD = 4.0
"""Power over the noise that a motion behind the errors would have in the other channel, which shows none."""


def denied(physical: Physical, predicted: Floats, left: tuple[Remainder, ...], channel: int) -> bool:
    """Whether what is left of a position or velocity is no motion, since the other of the two shows nothing.

    Such errors are the sensor's own: noise that wanders within the band of the motion, where its spectrum
    cannot be told.
    """
    evidence = physical.evidence
    here = evidence.channels[channel]
    other = next(
        (
            k
            for k, one in enumerate(evidence.channels)
            if one.place == here.place and one.family == PARTNER.get(here.family)
        ),
        None,
    )
    if other is None or left[other].in_train or left[other].in_held_out:
        return False
    step = float(np.median(np.diff(evidence.time))) * SAMPLES
    slow = _averages(np.nan_to_num(evidence.measured[:, channel] - predicted[:, channel]))
    white = np.random.default_rng(0).normal(size=slow.size) * physical.noise.sigma[channel] / np.sqrt(SAMPLES)
    scale = SAMPLES / float(physical.noise.sigma[other]) ** 2
    shown, chance = (_shown(one, here.family, step) * scale for one in (slow, white))
    seen = _averages(np.nan_to_num(errors_of(physical, predicted)[:, other]))
    return shown - 2.0 * chance > LOUD * max(1.0, float(np.mean(np.square(seen))) * SAMPLES)


def _shown(slow: Floats, family: str, step: float) -> float:
    """Power of what errors of a position or velocity would make of the other, were they motion."""
    if family == "position":
        return float(np.mean(np.square(np.gradient(slow, step))))
    moved, at = np.cumsum(slow - slow.mean()) * step, np.arange(slow.size)
    return float(np.mean(np.square(moved - np.polyval(np.polyfit(at, moved, 2), at))))


def _averages(values: Floats) -> Floats:
    count = values.size // SAMPLES
    return np.asarray(values[: count * SAMPLES].reshape(count, SAMPLES).mean(1))
