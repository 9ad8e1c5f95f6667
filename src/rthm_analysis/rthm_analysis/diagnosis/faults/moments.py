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

STRAYED = "The rig goes on behind it as if nothing had been. It was left out; check cables and the recorder."

PUSHED = (
    "Before and after, one model follows the recording. It was left out, and the motion behind it begins "
    "anew; find what it was, or record it as a load."
)


class Moment(NamedTuple):
    """From when to when, s, something pushed a plant; or its sensors alone `strayed`."""

    begin: float
    end: float
    strayed: bool = False


def without_moments(evidence: Evidence, moments: Sequence[Moment]) -> tuple[Evidence, tuple[Fault, ...]]:
    """Leave such moments out, and tell them: behind a push the motion begins anew."""
    measured = evidence.measured.copy()
    for one in moments:
        measured[_within(evidence, one)] = np.nan
    mended = replace(evidence, measured=measured)
    for one in moments:
        if not one.strayed:
            mended = mended.without_part(_within(mended, one))
    last = {one.strayed: one for one in moments}
    return mended, tuple(_told(one, last=one is last[one.strayed]) for one in moments)


def _within(evidence: Evidence, one: Moment) -> slice:
    """Samples in it."""
    first, end = np.searchsorted(evidence.time, [one.begin, one.end])
    return slice(int(first), int(end))


def _told(one: Moment, *, last: bool) -> Fault:
    """One of several; what follows from it is said behind the `last`."""
    between, interval = f"Between {bare(one.begin, 4)} s and {bare(one.end, 4)} s", (one.begin, one.end)
    if one.strayed:
        words = f"{between} the sensors of the plant show another motion than that of the rig."
        return Fault(
            "sensor.position", "stray", PLANT_STATE, f"{words} {STRAYED}" if last else words, interval
        )
    words = f"{between} something pushed the plant that neither its load nor its motion tells."
    return Fault("plant", "unrecorded_push", PLANT_STATE, f"{words} {PUSHED}" if last else words, interval)
