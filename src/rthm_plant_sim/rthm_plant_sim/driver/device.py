"""What a device gives and takes, in the units and the order of the spec."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from rthm_core.errors import InputError
from rthm_core.spec import Spec
from rthm_plant_sim.driver.zero import Zero

Values = float | Sequence[float] | NDArray[np.float64]
"""One number per dof or per actuator; a lone number where there is one."""


class Reading(NamedTuple):
    """What the sensors read at one instant; a plain tuple of the first four does as well.

    Attributes
    ----------
    position, velocity
        Of the n dofs of the plant, m and m/s; NaN where no velocity is measured.
    motor
        Positions of the m motors, m.
    force
        Measured forces of the m actuators, N, + pulls the plant along +x.
    motor_velocity, load
        Of the m motors, m/s, and known external loads on the n dofs, N; None: not measured.
    stamp
        Instant to which all this belongs, ns of the wall clock; None: the instant of the reading.
    """

    position: Values
    velocity: Values
    motor: Values
    force: Values
    motor_velocity: Values | None = None
    load: Values | None = None
    stamp: int | None = None


class Device(Protocol):
    """A rig: sensors that are read, motors that are commanded.

    It may also have ``hold()``, called when commands end, ``close()``, called at the end, and ``words()``,
    what it has to tell. Motors that keep their last command need none of these.
    """

    def read(self) -> Reading | tuple[Values, ...] | None:
        """Read all sensors now; None: no reading can be had, and no sample is made of this tick."""
        ...

    def command(self, u: NDArray[np.float64]) -> None:
        """Make `u` (m,), m, the command of the motors, now."""
        ...


class Layout:
    """Arrays of ``plant/state`` from the readings of a device.

    Parameters
    ----------
    spec
        A complete loop: its dofs and actuators.

    Attributes
    ----------
    zero
        What is subtracted from the readings, in their order.
    """

    def __init__(self, spec: Spec) -> None:
        loop = spec.loop()
        self.dofs, self.actuators = loop.plant.dofs, loop.actuator.names
        self.zero = Zero(spec)

    def values(self, reading: Reading) -> NDArray[np.float64]:
        """Position, velocity and effort (3, n + m), each of the dofs and then of the actuators.

        Raises
        ------
        InputError
            When a reading has another size than the spec.
        """
        n, m = len(self.dofs), len(self.actuators)
        read = np.array(
            [
                _sized("position", reading.position, n) + _sized("motor", reading.motor, m),
                _sized("velocity", reading.velocity, n) + _sized("motor_velocity", reading.motor_velocity, m),
                _sized("load", reading.load, n) + _sized("force", reading.force, m),
            ]
        )
        return read - self.zero.readings

    def motor(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Motor positions (m,) among the values of a reading."""
        return values[0, len(self.dofs) :]


def _sized(name: str, values: Values | None, size: int) -> list[float]:
    if values is None:
        return [float("nan")] * size
    found = [float(value) for value in np.ravel(values)]
    if len(found) != size:
        raise InputError(
            f"the {name} of a reading has {len(found)} values, but the spec has {size}; "
            "return one for each, in the order of the spec."
        )
    return found
