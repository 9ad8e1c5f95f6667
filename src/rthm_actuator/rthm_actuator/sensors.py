"""What a sample of ``plant/state`` measures, as one list of numbers with their names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

from rthm_core.spec import Spec

POSITION, VELOCITY, MOTOR, FORCE = "position", "velocity", "motor", "force"
SENSORS = {
    POSITION: ("position sensor", "m"),
    VELOCITY: ("velocity sensor", "m/s"),
    MOTOR: ("motor position sensor", "m"),
    FORCE: ("force sensor", "N"),
}
"""What each kind of channel is called, and its unit."""


class Sample(Protocol):
    """A JointState in the order of dofs, then actuators."""

    @property
    def stamp(self) -> int:
        """Instant to which the values belong, ns."""
        ...

    @property
    def position(self) -> list[float]:
        """Positions, m."""
        ...

    @property
    def velocity(self) -> list[float]:
        """Velocities, m/s."""
        ...

    @property
    def effort(self) -> list[float]:
        """Forces, N."""
        ...


class Channel(NamedTuple):
    """One measured number.

    Attributes
    ----------
    kind
        ``position``, ``velocity``, ``motor`` or ``force``.
    where
        Name of the dof or actuator.
    """

    kind: str
    where: str

    @property
    def words(self) -> str:
        """Name of the sensor."""
        return f"the {SENSORS[self.kind][0]} of {self.where}"

    @property
    def unit(self) -> str:
        """Its unit."""
        return SENSORS[self.kind][1]


class Sensors:
    """Channels of the plant of a spec.

    Parameters
    ----------
    spec
        The test.
    hardware
        Whether a real machine measures: then all sensors of the actuators are needed.

    Attributes
    ----------
    channels
        In the order of `values`.
    """

    def __init__(self, spec: Spec, hardware: bool = True) -> None:
        loop = spec.loop()
        self._dofs, dofs, actuators = loop.plant.n, loop.plant.dofs, loop.actuator.names
        self.channels = [
            *(Channel(kind, dof) for kind in (POSITION, VELOCITY) for dof in dofs),
            *(Channel(kind, actuator) for kind in (MOTOR, FORCE) for actuator in actuators),
        ]
        self._hardware = hardware
        self._velocity_used = any(loop.interface.damping) or loop.actuator.compensator != "none"

    def needed(self, channel: Channel) -> bool:
        """Whether the test cannot do without this channel."""
        if channel.kind == VELOCITY:
            return self._velocity_used
        return channel.kind == POSITION or self._hardware

    def values(self, sample: Sample) -> list[float]:
        """Values of all channels."""
        n = self._dofs
        return [*sample.position[:n], *sample.velocity[:n], *sample.position[n:], *sample.effort[n:]]

    def of(self, kind: str, values: Sequence[float]) -> list[float]:
        """Return the values of the channels of one kind."""
        return [value for channel, value in zip(self.channels, values, strict=True) if channel.kind == kind]


def known(value: float) -> bool:
    """Whether a number was measured at all."""
    return math.isfinite(value)
