"""Motion along the recording: that of a model, and what the recording has beyond it without its noise."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    SMOOTHED_FEWEST_SAMPLES,
    SMOOTHED_LEFT_RATIO,
    SMOOTHED_PERIOD_SHARE,
)
from rthm_analysis.diagnosis.missing.sites import Site
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Motion
from rthm_analysis.diagnosis.signals import smoothed
from rthm_core.compiled import Floats
from rthm_core.spec.effect import place_keys


class Along(NamedTuple):
    """Motion of a dof along the recording, with its known load, or of one relative to another, without any:
    (s,) arrays, m, m/s, s and N.
    """

    x: Floats
    v: Floats
    t: Floats
    load: Floats

    @property
    def a(self) -> Floats:
        """Acceleration (s,), m/s^2, with a little of the noise of the rates."""
        step = float(np.median(np.diff(self.t)))
        return smoothed(self.v, SMOOTHED_FEWEST_SAMPLES, 1) / step


def along(evidence: Evidence, motion: Motion, site: Site) -> Along:
    """Motion at a site as recorded, with the rates of the model where the recording has none."""
    dof, other = site.place
    name, beside = place_keys(site.name)
    here = _of_dof(evidence, motion, dof, name)
    if beside is None:
        return here
    there = _of_dof(evidence, motion, other, beside)
    return Along(here.x - there.x, here.v - there.v, here.t, np.zeros_like(here.load))


def _of_dof(evidence: Evidence, motion: Motion, dof: int, name: str) -> Along:
    """Motion of a dof.

    A model that is lost says nothing of it: what is recorded is then smoothed by itself.
    """
    step = float(np.median(np.diff(evidence.time)))
    widest = int(SMOOTHED_PERIOD_SHARE * evidence.period / step) // 2 * 2 + 1
    x, v = motion.position[:, dof], motion.velocity[:, dof]
    measured = {
        channel.family: evidence.measured[:, k]
        for k, channel in enumerate(evidence.channels)
        if channel.place == name
    }
    position, velocity = measured.get("position"), measured.get("velocity")
    if position is not None and np.nanstd(position - x) > np.nanstd(position):
        x, v = np.full_like(x, np.nanmean(position)), np.zeros_like(v)
    if position is not None:
        left = np.nan_to_num(position - x)
        width = _width(left, widest)
        x = x + smoothed(left, width)
        if velocity is None:
            v = v + smoothed(left, 2 * width + 1, 1) / step
    if velocity is not None:
        left = np.nan_to_num(velocity - v)
        v = v + smoothed(left, _width(left, widest))
    return Along(x, v, evidence.time, evidence.load[:, dof])


def _width(values: Floats, widest: int) -> int:
    """Samples of the longest parabolas that take no more than noise away."""
    width = SMOOTHED_FEWEST_SAMPLES
    allowed = SMOOTHED_LEFT_RATIO * float(np.std(values - smoothed(values, width)))
    while 2 * width + 1 <= widest and np.std(values - smoothed(values, 2 * width + 1)) < allowed:
        width = 2 * width + 1
    return width
