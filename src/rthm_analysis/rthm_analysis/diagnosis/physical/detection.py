"""What a recording would have shown: detection limits of every kind, in motors, wires, plant and sensors."""

from __future__ import annotations

from rthm_analysis.diagnosis.criteria.search import GAIN_OF_CHANCE, GAIN_PER_PARAMETER
from rthm_analysis.diagnosis.criteria.verdict import ROUNDING_STEP_RATIO
from rthm_analysis.diagnosis.fitting.limits import Limits, rounding_limits, slack_limits
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.result import Limit
from rthm_core.effects import effect


def detection_limits(physical: Physical) -> dict[str, Limit]:
    """Smallest sizes by ``block.kind.parameter``, with the place where there are several."""
    found = physical.selection.limits | physical.drive_limits | _slack_limits(physical)
    for key, step in rounding_limits(physical.fitting, ROUNDING_STEP_RATIO):
        found = {**found, key: {"step": step}}
    limits = {}
    for (block, kind, place), sizes in found.items():
        for name, size in sizes.items():
            unit = effect(kind, block).unit(name, block)
            many = len({p for b, k, p in found if (b, k) == (block, kind)}) > 1
            limits[f"{block}.{place}.{kind}.{name}" if many else f"{block}.{kind}.{name}"] = Limit(size, unit)
    return limits


def _slack_limits(physical: Physical) -> Limits:
    model, actuator = physical.selection.best.model, physical.spec.actuator
    if actuator is None or physical.evidence.driven_by != "command":
        return {}
    motion = physical.experiment.motion(model.spec, physical.windows)
    forces, noise = {}, {}
    for channel, sigma in zip(physical.evidence.channels, physical.sigma, strict=True):
        if channel.family == "force":
            forces[channel.place] = motion.force[: physical.train, actuator.names.index(channel.place)]
            noise[channel.place] = float(sigma)
    return slack_limits(model, forces, noise, GAIN_OF_CHANCE + GAIN_PER_PARAMETER)
