"""Sign and unit of a known force, and of a position that nothing but that force and the start can check."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    FAR_START_RATIO,
    FARTHEST_MOTION,
    LOAD_CORRELATION,
    LOAD_MOST_UNSURE,
    UNIT_AT_START_SHARE,
    UNITLESS_GAIN,
)
from rthm_analysis.diagnosis.faults.factors import scaled
from rthm_analysis.diagnosis.faults.naming import field_of
from rthm_analysis.diagnosis.faults.plant import plant_seen
from rthm_analysis.diagnosis.faults.scaling import FACTORS, factor_fault
from rthm_analysis.diagnosis.faults.smooth import smoothed
from rthm_analysis.diagnosis.faults.unit_ratios import known_factor
from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel, Evidence
from rthm_analysis.diagnosis.result import Fault

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def find_loads(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Check a plain recording, in which no commands tell signs and units.

    The motion tells the force that it needs. Where mass and stiffness both ask for the same other sign or
    unit, that of force or motion is wrong; which one it is, the spec's initial position tells.
    """
    if evidence.driven_by != "force" or spec.plant is None or len(spec.plant.dofs) != 1:
        return evidence, []
    channel = Channel("position", spec.plant.dofs[0])
    if channel not in evidence.channels:
        return evidence, []
    start, ratios = _start_factor(evidence, spec, channel), _force_ratios(evidence, spec)
    if start is not None and start != 1.0 and _agree(ratios, start) and (ratios or not evidence.load.any()):
        return corrected_position(evidence, channel, start, "what the start in the spec asks for")
    gain = _common(ratios, spec)
    if gain is None or gain == 1.0:
        return evidence, []
    reach = float(np.nanmax(np.abs(evidence.measured[:, evidence.channels.index(channel)])))
    if start is None and reach > FARTHEST_MOTION and abs(gain) < 1.0:
        return corrected_position(evidence, channel, 1.0 / gain, "what the known force asks for")
    told = factor_fault(Channel("load", channel.place), gain)
    if start is None and told.kind == "unit":
        other = f" It may as well be the motion that is {1.0 / gain:.4g} times what it should be."
        told = replace(told, words=told.words + other)
    return replace(evidence, load=evidence.load / gain), [told]


def _force_ratios(evidence: Evidence, spec: Spec) -> dict[str, float]:
    """Mass and stiffness that the known force asks for, over the spec's; none where they fit badly."""
    assert spec.plant is not None
    smooth = smoothed(evidence, spec.plant.dofs, ())
    seen = plant_seen(smooth, spec) if smooth is not None else None
    if seen is None or seen.correlation < LOAD_CORRELATION:
        return {}
    return {k: v for k, v in (("mass", seen.mass), ("stiffness", seen.stiffness)) if v is not None}


def _agree(ratios: dict[str, float], start: float) -> bool:
    """Whether a motion over this factor would need the known force, as far as that is told."""
    return all(UNITLESS_GAIN[0] <= ratio * start <= UNITLESS_GAIN[1] for ratio in ratios.values())


def _common(ratios: dict[str, float], spec: Spec) -> float | None:
    """Recorded over needed force where all ratios are the same sign and unit; None: nothing can be said."""
    unsure = spec.uncertainty.plant
    factors = {
        known_factor(ratio, "load", min(2.0 * float(getattr(unsure, name)), LOAD_MOST_UNSURE))
        for name, ratio in ratios.items()
    }
    return factors.pop() if len(factors) == 1 else None


def _start_factor(evidence: Evidence, spec: Spec, channel: Channel) -> float | None:
    """Recorded over specified start; None where the spec starts at zero, or it is another start.

    Of a free motion nothing confirms a unit: only a start that is far from the spec's is beyond chance.
    """
    assert spec.plant is not None
    nominal = spec.plant.initial_position[0]
    first = float(evidence.measured[0, evidence.channels.index(channel)])
    if nominal == 0.0 or not np.isfinite(first):
        return None
    ratio = first / nominal
    far = evidence.load.any() or not 1.0 / FAR_START_RATIO < abs(ratio) < FAR_START_RATIO
    factor = known_factor(ratio, "position", 0.0 if far else LOAD_MOST_UNSURE)
    return factor if factor is not None and abs(ratio / factor - 1.0) < UNIT_AT_START_SHARE else None


def corrected_position(
    evidence: Evidence, channel: Channel, factor: float, shown: str
) -> tuple[Evidence, list[Fault]]:
    """Correct a position, and its rates with it: these agree."""
    every = [one for one in _motion_of(channel.place) if one in evidence.channels]
    faults = [factor_fault(one, factor, shown) for one in every]
    return scaled(evidence, {(one.family, one.place): factor for one in every}), faults


def _motion_of(dof: str) -> list[Channel]:
    return [Channel(family, dof) for family in MOTION]


def told_by_one(evidence: Evidence, faults: list[Fault], spec: Spec) -> tuple[Evidence, list[Fault]]:
    """One wrong position in place of wrong rates, where the known force says so.

    Rates are judged by the position: where that is wrong, they are found to be, and the known force does not
    fit the motion.
    """
    if evidence.driven_by != "force" or spec.plant is None or len(spec.plant.dofs) != 1:
        return evidence, faults
    motion = [one for one in _motion_of(spec.plant.dofs[0]) if one in evidence.channels]
    rates = motion[1:]
    wrong = [one for one in faults if one.channel in map(field_of, rates) and one.kind in FACTORS]
    if len(wrong) < len(rates) or not wrong or not wrong[0].value:
        return evidence, faults
    factor = 1.0 / wrong[0].value
    moved = scaled(evidence, {(one.family, one.place): factor for one in motion})
    before, after = _force_ratios(evidence, spec), _force_ratios(moved, spec)
    if not after or not _agree(after, 1.0) or _agree(before, 1.0):
        return evidence, faults
    alone = factor_fault(motion[0], factor, f"what its {rates[0].family} and the known force ask for")
    return moved, [alone, *(one for one in faults if one not in wrong)]
