"""Every effect that the physical side of a recording could have, with its starting values."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Motion
from rthm_analysis.diagnosis.replay.model import EffectInstance
from rthm_analysis.diagnosis.search.scene import dof_scene, rms, seen_in, wire_scene
from rthm_analysis.diagnosis.search.starts import PLANT, WIRE, InitialGuess, declared

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

FRICTION = ("coulomb_friction", "stribeck_friction")


def candidates(spec: Spec, evidence: Evidence, motion: Motion, sigma: Floats) -> Iterator[InitialGuess]:
    """Starts of all kinds in plant, wires and sensors that `spec` does not have already."""
    assert spec.plant is not None
    present = {(e.block, e.kind, e.place) for e in spec.effects}
    rubbed = {e.place for e in spec.effects if e.block == "plant" and e.kind in FRICTION}
    for dof in spec.plant.dofs:
        scene = dof_scene(spec, evidence, motion, dof)
        for kind, find in PLANT.items():
            if ("plant", kind, dof) not in present and not (kind in FRICTION and dof in rubbed):
                yield from _finite(find(scene))
        yield from (start for start in _finite(declared("plant", scene)) if start.label not in present)
    if evidence.driven_by == "command" and spec.actuator is not None:
        for actuator in spec.actuator.names:
            scene = wire_scene(spec, evidence, motion, actuator)
            for kind, find in WIRE.items():
                if ("wire", kind, actuator) not in present:
                    yield from _finite(find(scene))
            yield from (start for start in _finite(declared("wire", scene)) if start.label not in present)
    for start in sensor_starts(evidence, sigma):
        if start.label not in present:
            yield start


def _finite(starts: Iterator[InitialGuess]) -> Iterator[InitialGuess]:
    """Starts whose numbers exist: a dof that does not move has none."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"), suppress(ZeroDivisionError):
        for start in starts:
            if all(isinstance(v, str) or np.isfinite(v) for v in start.added.parameters.values()):
                yield start


def sensor_starts(evidence: Evidence, sigma: Floats) -> Iterator[InitialGuess]:
    """Bias, scale, drift and lag of every sensor whose signal another channel can check.

    In a recording with one channel alone a sensor cannot be told from what it measures; of a plant alone, a
    position that is off may be a force, but not a velocity that the position does not follow.
    """
    if len(evidence.channels) < 2:
        return
    checked = ("velocity",) if evidence.driven_by == "force" else ("position", "velocity", "force")
    duration = float(evidence.time[-1]) or 1.0
    seen = seen_in(evidence.time)
    for channel, noise, column in zip(evidence.channels, sigma, evidence.measured.T, strict=True):
        if channel.family not in checked:
            continue
        spread = float(np.nanstd(column)) or 1.0
        rate = rms(np.nan_to_num(np.gradient(column, evidence.time)))
        block, small = f"sensor.{channel.family}", 0.3 * float(noise)
        for kind, key, value, neutral, signed in (
            ("bias", "bias", small, 0.0, True),
            ("scale", "scale", 1.0 + small / spread, 1.0, True),
            ("drift", "rate", small / duration, 0.0, True),
            ("lag", "time_constant", min(small / max(rate, 1e-300), 1e-3), 0.0, False),
        ):
            added = EffectInstance(block, kind, channel.place, {key: value}, seen)
            yield InitialGuess(added, (key,), (key,), {key: abs(value - neutral)}, signed, neutral)
