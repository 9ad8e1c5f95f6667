"""A rig at rest: what its sensors read, how well that is known, and whether it rests at all."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_actuator.sensors import FORCE, VELOCITY, Channel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rthm_core.compiled import Floats

PARTS = 10
"""Stretches of a rest whose means are compared."""
AT_REST_WITHIN = 0.1
"""How far these may lie apart, over `limits.start`."""


class Reading(NamedTuple):
    """A sensor of a rig at rest.

    Attributes
    ----------
    channel
        Which one.
    mean, std
        What it reads, and how well that is known, in its unit; NaN: nothing.
    moved, allowed
        How far the means of its stretches lie apart, and how far they may.
    """

    channel: Channel
    mean: float
    std: float
    moved: float
    allowed: float

    @property
    def line(self) -> str:
        """All of it, for the eye."""
        if not math.isfinite(self.mean):
            return f"{self.channel.words}: not measured"
        return f"{self.channel.words}: {self.mean:.6g} +- {self.std:.2g} {self.channel.unit}"


def readings(channels: Sequence[Channel], values: Floats, start: tuple[float, float]) -> list[Reading]:
    """Judge the samples (s, k) of all channels.

    Parameters
    ----------
    start
        `limits.start` of the spec: m, N. A velocity is not judged, as positions are.
    """
    parts = np.array_split(values, PARTS)
    means = np.array([part.mean(axis=0) for part in parts])
    allowed = {FORCE: AT_REST_WITHIN * start[1], VELOCITY: math.inf}
    return [
        Reading(
            channel,
            float(values[:, i].mean()),
            float(means[:, i].std(ddof=1) / math.sqrt(PARTS)),
            float(np.ptp(means[:, i])),
            allowed.get(channel.kind, AT_REST_WITHIN * start[0]),
        )
        for i, channel in enumerate(channels)
    ]


def unrest(found: Sequence[Reading]) -> str:
    """Why a rig does not rest, in one sentence; empty when it does."""
    for one in found:
        if one.moved > one.allowed:
            unit = one.channel.unit
            return (
                f"The rig is not at rest, and no zero was taken: {one.channel.words} moved by {one.moved:.3g}"
                f" {unit}, where {one.allowed:.3g} {unit} are allowed; let it come to rest, and try again."
            )
    return ""
