"""Whether the motors did what is known of them, by their own sensors and by the forces of their wires."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import (
    MOTOR_EXPLAINED_SHARE,
    MOTOR_SENSOR_OFF_RATIO,
    NOISE_FLOOR_RATIO,
    SMOOTH_LAW_EXPLAINED_SHARE,
    WIRE_SLOW_POWER,
)
from rthm_analysis.diagnosis.fitting.wires_alone import WiresAlone
from rthm_analysis.diagnosis.physical.remainder import averages, slow_power
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.physical.side import Physical


def drives_earned(rounds: Sequence[Sequence[FittedCandidate]]) -> bool:
    """Whether the effects found in the motors bring these to the noise, or nearly all of the way there."""
    if not rounds:
        return False
    first, last = rounds[0][-1].fitted, rounds[-1][0].fitted
    noise = max(last.samples, 1)
    may_be_left = (1.0 - SMOOTH_LAW_EXPLAINED_SHARE) * (first.squares - noise)
    return last.squares < NOISE_FLOOR_RATIO**2 * noise or last.squares - noise < may_be_left


def is_driven_wrong(physical: Physical) -> bool:
    """Whether the motors do what no kind explains, so that nobody knows what the wires were given."""
    if physical.drives:
        return not drives_earned(physical.drives)
    return wires_are_off(physical) and _forces_follow_motors(physical)


def motors_read_wrong(physical: Physical) -> bool:
    """Whether the motors' sensors are far from what the commands make, where no force follows that."""
    left = physical.motor_left
    if not left.size or physical.drives or physical.motor_wanders:
        return False
    off = np.sqrt(np.nanmean(np.square(left), axis=0))
    return bool(np.any(off > MOTOR_SENSOR_OFF_RATIO)) and not _forces_follow_motors(physical)


def wires_are_off(physical: Physical) -> bool:
    """Whether the force of a wire is not the one that the recorded motion gives."""
    models = (physical.nominal.model, physical.selection.base.model)
    return forces_are_off(physical.fitting.wires_alone, models)


def forces_are_off(alone: WiresAlone, models: Sequence[Model]) -> bool:
    """Whether the force of a wire is not the one that the recorded motion gives.

    A wire is right if it is so with the values of the spec or with those of the retuned model, which what is
    missing in the plant may have drawn away.
    """
    return bool(alone.forces) and all(_are_off(alone, model) for model in models)


def _are_off(alone: WiresAlone, model: Model) -> bool:
    columns = alone.residual(model).reshape(-1, len(alone.forces))
    return any(slow_power(column)[0] > WIRE_SLOW_POWER for column in columns.T)


def _forces_follow_motors(physical: Physical) -> bool:
    return forces_follow(physical.fitting.wires_alone, physical.nominal.model, physical.motor_left)


def forces_follow(alone: WiresAlone, model: Model, motors: Floats) -> bool:
    """Whether what the motors' sensors have beyond the commands (s, m) is what the wires' forces have."""
    if not motors.size:
        return False
    left = alone.residual(model).reshape(-1, len(alone.forces))
    assert model.spec.actuator is not None
    names = model.spec.actuator.names
    for column, channel in zip(left.T, alone.forces, strict=True):
        actuator = names.index(alone.experiment.evidence.channels[channel].place)
        force, motor = averages(column), averages(np.nan_to_num(motors[:, actuator]))
        gone = float(force @ motor) ** 2 / max(float(motor @ motor) * float(force @ force), 1e-300)
        if slow_power(column)[0] > WIRE_SLOW_POWER and gone > MOTOR_EXPLAINED_SHARE:
            return True
    return False
