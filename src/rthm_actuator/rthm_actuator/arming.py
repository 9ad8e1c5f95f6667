"""Arming: nothing moves before the rig has been compared with the start of the spec."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rthm_actuator.sensors import FORCE, MOTOR, POSITION, Channel, Sensors, known
from rthm_core.controller import Controller
from rthm_core.spec import Spec


class Difference(NamedTuple):
    """A sensor that does not read what the spec says.

    Attributes
    ----------
    channel
        The sensor.
    measured, expected, allowed
        What it reads, what the spec has there, and the largest difference; m or N.
    """

    channel: Channel
    measured: float
    expected: float
    allowed: float

    @property
    def words(self) -> str:
        """Both figures, in one clause."""
        unit = self.channel.unit
        if not known(self.measured):
            return f"{self.channel.words} reads {self.measured:g}"
        return (
            f"{self.channel.words} reads {self.measured:.6g} {unit} and the spec begins at "
            f"{self.expected:.6g} {unit}, {abs(self.measured - self.expected):.6g} {unit} away where "
            f"limits.start allows {self.allowed:.6g} {unit}"
        )

    @property
    def value(self) -> float:
        """How far the sensor is from the spec."""
        return abs(self.measured - self.expected)


def expected_start(spec: Spec) -> dict[Channel, float]:
    """What the sensors read where the test of a spec begins: positions, motor positions and forces."""
    loop, controller = spec.loop(), Controller(spec)
    motors, forces = controller.command(0), controller.force
    return {
        **{
            Channel(POSITION, dof): x
            for dof, x in zip(loop.plant.dofs, loop.plant.initial_position, strict=True)
        },
        **{Channel(MOTOR, name): float(u) for name, u in zip(loop.actuator.names, motors, strict=True)},
        **{Channel(FORCE, name): float(f) for name, f in zip(loop.actuator.names, forces, strict=True)},
    }


def differences(spec: Spec, values: Sequence[float], allowed: Sequence[float]) -> list[Difference]:
    """Sensors that are further from the start of the spec than is allowed, the furthest first.

    Parameters
    ----------
    values
        Of all channels, in the order of `Sensors`.
    allowed
        Largest difference in m and in N.
    """
    measured = dict(zip(Sensors(spec).channels, values, strict=True))
    found = [
        Difference(channel, measured[channel], expected, allowed[channel.kind == FORCE])
        for channel, expected in expected_start(spec).items()
    ]
    beyond = [one for one in found if not one.value <= one.allowed]
    return sorted(beyond, key=lambda one: -np.nan_to_num(one.value / one.allowed, nan=np.inf))
