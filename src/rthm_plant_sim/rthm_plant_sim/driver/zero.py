"""What a driver subtracts from the readings of its device, so that the rest knows the rig's own zero only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rthm_core.slew import Floats
    from rthm_core.spec import Spec

SECTION = "zero"
"""Section of the spec, and first part of the names of the parameters."""
WORDS = "what is subtracted from the readings; commands are given from the zero of the motors"
OF_DOFS, OF_ACTUATORS = ("position", "velocity"), ("motor", "force")


class Zero:
    """Zero of all sensors of a rig.

    Parameters
    ----------
    spec
        A complete loop; its section ``zero``, where it has one.

    Attributes
    ----------
    values
        Of each kind of sensor, in the order of the spec.
    """

    def __init__(self, spec: Spec) -> None:
        loop = spec.loop()
        self._n, self._m = len(loop.plant.dofs), len(loop.actuator.names)
        sizes = dict.fromkeys(OF_DOFS, self._n) | dict.fromkeys(OF_ACTUATORS, self._m)
        self.values = {name: np.zeros(size) for name, size in sizes.items()}
        for name in self.values:
            given = getattr(spec.zero, name) if spec.zero else None
            if given is not None:
                self.values[name] = np.array(given, dtype=float)

    @property
    def motor(self) -> Floats:
        """Of the motors (m,), m."""
        return self.values["motor"]

    @property
    def readings(self) -> Floats:
        """Of position, velocity and effort (3, n + m), each of the dofs and then of the actuators."""
        v = self.values
        still, unloaded = np.zeros(self._m), np.zeros(self._n)
        return np.array(
            [
                np.concatenate([v["position"], v["motor"]]),
                np.concatenate([v["velocity"], still]),
                np.concatenate([unloaded, v["force"]]),
            ]
        )

    def taken(self, told: Mapping[str, Sequence[float]]) -> str:
        """Take other values over, all or none; why not, empty where they are taken."""
        for name, values in told.items():
            size = self.values[name].size if name in self.values else 0
            if np.shape(values) != (size,) or not np.isfinite(values).all():
                return f"{SECTION}.{name} is {list(values)}, but must be {size} finite numbers"
        self.values |= {name: np.array(values, dtype=float) for name, values in told.items()}
        return ""
