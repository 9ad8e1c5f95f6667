"""Sensors that are not linear: what is left of one signal is a curve over its own reading.

A force leaves what the dynamics of the rig make of it, in every signal. An error of a sensor shows at once,
in its own signal alone, and is the same whenever the reading is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    BENT_FEWEST_SAMPLES,
    BENT_SHARE,
    BENT_SHARE_LOST,
)
from rthm_analysis.diagnosis.criteria.verdict import NOISE_FLOOR_RATIO
from rthm_analysis.diagnosis.faults.bend import Bend, bend_of, curve_share, share_of
from rthm_analysis.diagnosis.faults.naming import in_words
from rthm_analysis.diagnosis.physical.judged import begun_runs, by_starts
from rthm_analysis.diagnosis.physical.leaves_noise import explained_by_kinds
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Channel
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class BentSensor:
    """A sensor that is not linear.

    Attributes
    ----------
    channel : Channel
    bend : Bend
    is_clear : bool
        Whether no known kind of physics explains the same.
    """

    channel: Channel
    bend: Bend
    is_clear: bool


def bent_sensors(physical: Physical) -> list[BentSensor]:
    """Sensors whose error is a curve over their own reading, as unseen data confirm.

    Only where all other signals are at their noise: a force shows in them, too.
    """
    runs, predicted = begun_runs(physical, physical.selection.base)
    if not np.isfinite(predicted).all():
        return []
    left = physical.evidence.measured - predicted
    loud = np.sqrt(np.nanmean(np.square(left), axis=0)) > NOISE_FLOOR_RATIO * physical.noise.level
    is_clear = not explained_by_kinds(physical.fitting, physical.selection)
    found = []
    for k, channel in enumerate(physical.evidence.channels):
        bend = None if np.delete(loud, k).any() else _confirmed(physical, runs, predicted, k)
        if bend is not None:
            found.append(BentSensor(channel, bend, is_clear))
    return found if len(found) == 1 else []


def _confirmed(physical: Physical, runs: Windows, predicted: Floats, column: int) -> Bend | None:
    """The bend of a channel that training and unseen part show alike."""
    true = predicted[:, column]
    left = physical.evidence.measured[:, column] - true
    known, first = np.isfinite(left), np.arange(left.size) < physical.train
    seen, unseen = known & first, known & ~first
    if min(np.count_nonzero(seen), np.count_nonzero(unseen)) < BENT_FEWEST_SAMPLES:
        return None
    if curve_share(true[seen], left[seen]) < BENT_SHARE - BENT_SHARE_LOST:
        return None
    # Readings that are off have told where the runs begin.
    starts = by_starts(physical.experiment, physical.selection.base.model.spec, runs, predicted)[:, column]
    beside = starts if np.isfinite(starts).all() else starts[:, :0]
    bend = bend_of(true[seen], left[seen], beside[seen])
    shares = [share_of(bend, true[part], left[part]) for part in (seen, unseen)]
    return bend if min(shares) > BENT_SHARE else None


def straight_or_curved(found: list[BentSensor]) -> tuple[str, ...]:
    """What the recording does not tell from a sensor that is not linear, one sentence each."""
    return tuple(
        f"What is told of the rig may as well be an error of the sensor of {in_words(one.channel)} that "
        "depends on its reading: check its calibration."
        for one in found
        if not one.is_clear
    )
