"""Every effect that the physical side of a recording could have, with its starting values."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import combinations, product
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel, Evidence
from rthm_analysis.diagnosis.replay.experiment import Motion
from rthm_analysis.diagnosis.search.scene import between_scene, dof_scene, seen_in, sensor_scene, wire_scene
from rthm_analysis.diagnosis.search.starts import InitialGuess, guessed
from rthm_core.effects.registry import ranked

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.effects import Effect
    from rthm_core.spec import Spec


def candidates(spec: Spec, evidence: Evidence, motion: Motion, sigma: Floats) -> Iterator[InitialGuess]:
    """Starts of all kinds in plant, wires and sensors that `spec` does not have already."""
    present = {(e.block, e.kind, e.place) for e in spec.effects}
    singles = {("friction", e.place) for e in spec.effects if e.law.jump}
    singles |= {("gain", e.place) for e in spec.effects if e.law.changes == "gain"}
    for start in (
        *_plant_starts(spec, evidence, motion),
        *_wire_starts(spec, evidence, motion),
        *sensor_starts(evidence, sigma),
    ):
        if start.label not in present and start.single not in singles:
            yield start


def _plant_starts(spec: Spec, evidence: Evidence, motion: Motion) -> Iterator[InitialGuess]:
    assert spec.plant is not None
    alone = [dof_scene(spec, evidence, motion, dof) for dof in spec.plant.dofs]
    apart = [between_scene(one, other) for one, other in combinations(alone, 2)]
    between = [law for law in ranked("plant") if law.between_dofs]
    for scenes, laws in ((alone, ranked("plant")), (apart, between)):
        for scene, law in product(scenes, laws):
            yield from _finite(guessed(law, "plant", scene.place, scene, scene.seen))


def _wire_starts(spec: Spec, evidence: Evidence, motion: Motion) -> Iterator[InitialGuess]:
    if evidence.driven_by != "command" or spec.actuator is None:
        return
    for actuator in spec.actuator.names:
        scene = wire_scene(spec, evidence, motion, actuator)
        for law in ranked("wire"):
            yield from _finite(guessed(law, "wire", actuator, scene, scene.seen))


def _finite(starts: Iterator[InitialGuess]) -> Iterator[InitialGuess]:
    """Starts whose numbers exist: a dof that does not move has none."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"), suppress(ZeroDivisionError):
        for start in starts:
            if all(isinstance(v, str) or np.isfinite(v) for v in start.added.parameters.values()):
                yield start


def sensor_starts(evidence: Evidence, sigma: Floats) -> Iterator[InitialGuess]:
    """What can be wrong with every sensor whose signal another channel can check.

    In a recording with one channel alone a sensor cannot be told from what it measures. Of a plant alone, a
    position that is off may be a force; but no plant has a velocity of which a part goes nowhere, that is not
    the rate of its position, or an acceleration that is no rate of its motion. The offset of an acceleration
    is nothing that is wrong.
    """
    if len(evidence.channels) < 2:
        return
    checked = MOTION if evidence.driven_by == "force" else (*MOTION, "force")
    seen = seen_in(evidence.time)
    for channel, noise, column in zip(evidence.channels, sigma, evidence.measured.T, strict=True):
        if channel.family not in checked:
            continue
        block, scene = f"sensor.{channel.family}", sensor_scene(evidence.time, column, float(noise))
        for law in ranked(block):
            if _can_be_told(law, channel, evidence):
                only = law.changes == "gain" and evidence.driven_by == "force"
                starts = guessed(law, block, channel.place, scene, seen)
                yield from (replace(one, only_gain=only) for one in starts)


def _can_be_told(law: type[Effect], channel: Channel, evidence: Evidence) -> bool:
    """Whether what is wrong with the sensor of a channel is nothing that the rig could be."""
    if channel.family == "acceleration":
        return law.changes != "offset"
    if evidence.driven_by != "force":
        return True
    if law.changes in ("gain", "smoothing"):
        return {Channel("position", channel.place), Channel("velocity", channel.place)} <= {
            *evidence.channels
        }
    return channel.family == "velocity" and law.changes in ("offset", "growth")
