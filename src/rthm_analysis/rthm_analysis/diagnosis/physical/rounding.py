"""Sensors that round: their readings lie on a lattice, which needs no fit to be seen."""

from __future__ import annotations

from typing import Any

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import (
    ROUNDING_BEYOND_SHARE,
    ROUNDING_ERROR_STEPS,
    ROUNDING_STEP_RATIO,
)
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF
from rthm_analysis.diagnosis.replay.readings import lattice
from rthm_analysis.diagnosis.result import Physics, Value
from rthm_analysis.diagnosis.words import physics_words
from rthm_core.compiled import Floats
from rthm_core.effects.registry import changing
from rthm_core.spec.effect import placed


def rounded_sensors(physical: Physical, predicted: Floats) -> list[Physics]:
    """Sensors whose rounding matters beside everything else that is left."""
    found = []
    known = {(e.block, e.place) for e in physical.spec.effects if e.law.changes == "step"}
    for k, channel in enumerate(physical.evidence.channels):
        block = f"sensor.{channel.family}"
        if (block, channel.place) in known:
            continue
        measured = physical.evidence.measured[: physical.train, k]
        step = lattice(measured)
        left = float(np.sqrt(np.nanmean(np.square(measured - predicted[: physical.train, k]))))
        if step is None or step < ROUNDING_STEP_RATIO * left:
            continue
        values: dict[str, Value | str] = {"step": Value(step, 1e-6 * step, UNIT_OF[channel.family])}
        kind = changing(block, "step").kind
        words = physics_words(block, kind, channel.place, values, float("nan"), 0.0)
        found.append(Physics(block, kind, channel.place, values, words, 0.0, 0.0))
    return found


def is_rounding(physical: Physical, predicted: Floats, channel: int) -> bool:
    """Whether a channel reads what a model predicts, rounded to its steps."""
    measured = physical.evidence.measured[:, channel]
    step = lattice(measured[: physical.train])
    if step is None:
        return False
    beyond = np.abs(measured - predicted[:, channel]) > ROUNDING_ERROR_STEPS * step
    return float(np.mean(beyond)) <= ROUNDING_BEYOND_SHARE


def rounded_section(one: Physics) -> dict[str, Any]:
    """Section of a spec."""
    step = one.parameters["step"]
    assert isinstance(step, Value)
    return {"block": one.block, "kind": one.kind, **placed(one.block, str(one.place)), "step": step.value}
