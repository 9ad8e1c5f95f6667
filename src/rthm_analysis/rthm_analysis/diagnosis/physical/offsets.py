"""Offsets of accelerometers: every comparison takes them out, so that they are told as notes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import OFFSET_TOLD_STDS
from rthm_analysis.diagnosis.numbers import number
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF
from rthm_analysis.diagnosis.replay.experiment import effects_on
from rthm_analysis.diagnosis.replay.sensing import sensed
from rthm_core.compiled import Floats


def offsets(physical: Physical, predicted: Floats) -> Iterator[str]:
    """What was taken out of each acceleration, in words; nothing where the noise may have made it.

    Parameters
    ----------
    physical : Physical
    predicted : (s, k) array
        What the model that was found reads, offsets included.
    """
    evidence, spec = physical.evidence, physical.selection.best.model.spec
    assert spec.plant is not None
    names = evidence.names if evidence.has_several else [""] * len(evidence.recordings)
    for k, channel in enumerate(evidence.channels):
        if channel.family != "acceleration":
            continue
        moved = physical.experiment.motion(spec, physical.windows).acceleration
        true = moved[:, spec.plant.dofs.index(channel.place)]
        beyond = predicted[:, k] - sensed(evidence.time, true, effects_on(spec, channel))
        for name, one in zip(names, evidence.recordings, strict=True):
            offset = float(np.mean(beyond[one]))
            std = float(physical.sigma[k]) / np.sqrt(np.count_nonzero(np.isfinite(evidence.measured[one, k])))
            if abs(offset) > OFFSET_TOLD_STDS * std:
                where = f" in {name}" if name else ""
                size = number(offset, std, UNIT_OF[channel.family], signed=True)
                yield (
                    f"An offset of {size} was taken out of the acceleration of {channel.place}{where}: every "
                    "accelerometer has one, and gravity makes one where it is not level."
                )
