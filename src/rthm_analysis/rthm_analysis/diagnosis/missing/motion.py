"""Motion along the recording: that of a model, and what the recording has beyond it without its noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import SMOOTHED_FEWEST_SAMPLES, SMOOTHED_PERIOD_SHARE
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Motion
from rthm_analysis.diagnosis.replay.windows import period
from rthm_core.compiled import Floats


class Along(NamedTuple):
    """Motion of one dof along the recording, with its known load: (s,) arrays, m, m/s, s and N."""

    x: Floats
    v: Floats
    t: Floats
    load: Floats


def along(evidence: Evidence, motion: Motion, dof: int, name: str) -> Along:
    """Motion of a dof as recorded, with the rates of the model where the recording has none."""
    from scipy.signal import savgol_filter

    step = float(np.median(np.diff(evidence.time)))
    width = max(int(SMOOTHED_PERIOD_SHARE * period(evidence) / step) // 2 * 2 + 1, SMOOTHED_FEWEST_SAMPLES)
    found = {"position": motion.position[:, dof].copy(), "velocity": motion.velocity[:, dof].copy()}
    left = {}
    for k, channel in enumerate(evidence.channels):
        if channel.place == name and channel.family in found:
            left[channel.family] = np.nan_to_num(evidence.measured[:, k] - found[channel.family])
    if "position" in left:
        found["position"] += savgol_filter(left["position"], width, 2)
    if "velocity" in left:
        found["velocity"] += savgol_filter(left["velocity"], width, 2)
    elif "position" in left:
        found["velocity"] += savgol_filter(left["position"], 2 * width + 1, 2, deriv=1, delta=step)
    return Along(found["position"], found["velocity"], evidence.time, evidence.load[:, dof])
