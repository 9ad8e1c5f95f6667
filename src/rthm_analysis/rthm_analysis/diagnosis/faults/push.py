"""A moment in which something pushed a plant, or its sensors showed another motion than that of the rig."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.topics import PLANT_STATE


class Push(NamedTuple):
    """Samples in which a plant was pushed: the first, and the one behind the last; or in which its sensors
    alone were `off`.
    """

    first: int
    end: int
    off: bool = False


def without_pushes(evidence: Evidence, pushes: Sequence[Push]) -> tuple[Evidence, tuple[Fault, ...]]:
    """Leave such moments out, and tell them: behind a push the motion begins anew."""
    measured, faults = evidence.measured.copy(), []
    for one in pushes:
        begin, end = float(evidence.time[one.first]), float(evidence.time[one.end - 1])
        measured[one.first : one.end] = np.nan
        faults.append(_told(begin, end, off=one.off))
    mended = replace(evidence, measured=measured)
    for one in sorted(pushes, reverse=True):
        if not one.off:
            mended = mended.without_samples(one.first, one.end)
    return mended, tuple(faults)


def _told(begin: float, end: float, *, off: bool) -> Fault:
    between = f"Between {bare(begin, 4)} s and {bare(end, 4)} s"
    if off:
        words = (
            f"{between} the sensors of the plant show another motion than that of the rig, which goes on "
            "behind it as if nothing had been. It was left out; check cables and the recorder."
        )
        return Fault("sensor.position", "stray", PLANT_STATE, words, (begin, end))
    words = (
        f"{between} something pushed the plant that neither its load nor its motion tells: one model follows "
        "the recording before and after. It was left out, and the motion behind it begins anew; find what it "
        "was, or record it as a load."
    )
    return Fault("plant", "unrecorded_push", PLANT_STATE, words, (begin, end))
