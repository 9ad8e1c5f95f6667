"""Moments in which something pushed a plant, or its sensors showed another motion than that of the rig."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import PUSH_FEWEST_SAMPLES_BEHIND
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.result import Described, Fault


class Moment(NamedTuple):
    """From when to when, s, something pushed a plant, and with what; or which channels `strayed`."""

    begin: float
    end: float
    push: Described | None = None
    strayed: tuple[Channel, ...] = ()


def without_moments(evidence: Evidence, moments: Sequence[Moment]) -> tuple[Evidence, tuple[Fault, ...]]:
    """Leave such moments out, and tell those of sensors: behind a push the motion begins anew."""
    measured = evidence.measured.copy()
    for one in moments:
        for channel in one.strayed:
            measured[_within(evidence, one), evidence.channels.index(channel)] = np.nan
    mended = replace(evidence, measured=measured)
    for one in moments:
        if one.push is not None:
            mended = mended.without_part(_within(mended, one))
    return mended, tuple(_strayed(one, channel) for one in moments for channel in one.strayed)


def _within(evidence: Evidence, one: Moment) -> slice:
    """Samples in it, and those behind it where they are too few for a run of their own."""
    first, end = np.searchsorted(evidence.time, [one.begin, one.end])
    size = evidence.stamps_ns.size
    return slice(int(first), size if size - end < PUSH_FEWEST_SAMPLES_BEHIND else int(end))


def _strayed(one: Moment, channel: Channel) -> Fault:
    between = f"Between {bare(one.begin, 4)} s and {bare(one.end, 4)} s"
    words = (
        f"{between} {in_words(channel)} is not that of the rig, which goes on behind it as if nothing had "
        "been. It was left out; check cable and recorder."
    )
    return fault_of(channel, "stray", words, (one.begin, one.end))
