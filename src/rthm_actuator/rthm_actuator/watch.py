"""All watchers of one rig, asked at every sample that arrives."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rthm_actuator.sensors import FORCE, MOTOR, Channel, Sample, Sensors, known
from rthm_actuator.supervision import MEASURED, Broken, Following, Frozen, Largest, Step, not_finite
from rthm_core.clock import to_ns
from rthm_core.limits import FROZEN_TRAVEL
from rthm_core.slew import Floats
from rthm_core.spec import LimitsSpec, Spec
from rthm_core.substructure import interface


class Watch:
    """Looks at what the rig measures.

    Parameters
    ----------
    spec
        The test.
    limits
        Its limits, with their defaults.
    hardware
        Whether a real machine measures.
    executed
        Whether the commands go to the motors; in a dry run no sensor has to move with them.

    Attributes
    ----------
    values
        Of all channels in the newest sample, with a velocity that nobody needs and nobody measures as 0;
        empty before the first one.
    """

    def __init__(self, spec: Spec, limits: LimitsSpec, hardware: bool, executed: bool = True) -> None:
        self._sensors = Sensors(spec, hardware)
        channels = self._sensors.channels
        self._rows, self._dofs = interface(spec).plant, spec.loop().plant.n
        self.values: list[float] = []
        self._stiffness = np.array(spec.k_tot)
        self._largest = Largest(channels, {name: getattr(limits, name) for name in MEASURED})
        self._looks: list[Callable[[int, list[float], Floats, int], Broken | None]] = []
        if limits.step is not None:
            timing = spec.loop().timing
            step = Step(channels, limits.step, timing.ns("td1"), timing.ns("td3"))
            self._looks.append(lambda stamp, values, command, late: step.look(stamp, values))
        self._looks.append(lambda stamp, values, command, late: self._largest.look(values))
        if executed and limits.frozen is not None:
            travel = FROZEN_TRAVEL * (limits.command or 0.0)
            self._looks.append(Frozen(channels, to_ns(limits.frozen), travel).look)
        if executed and limits.following is not None:
            following = Following(spec.loop().actuator.names, limits.following)
            self._looks.append(
                lambda stamp, values, command, late: following.look(self.motors.tolist(), command)
            )

    @property
    def motors(self) -> Floats:
        """Measured positions (m,) of the motors, m."""
        return np.array(self._sensors.of(MOTOR, self.values))

    @property
    def unloaded(self) -> Floats:
        """Where the motors (m,) would pull with no force, m."""
        pull: Floats = np.array(self._sensors.of(FORCE, self.values)) / self._stiffness
        return self.motors - pull

    def interface(self, sample: Sample) -> tuple[Floats, Floats]:
        """Position and velocity (m,) of the plant in a sample, at the interface."""
        values = np.array(self._known(self._sensors.values(sample)))
        return values[self._rows], values[self._rows + self._dofs]

    def note(self, sample: Sample) -> None:
        """Take a sample as the newest one, without a look at it."""
        self.values = self._known(self._sensors.values(sample))

    def see(self, sample: Sample, command: Floats, late: int = 0) -> Broken | None:
        """Look at a sample that is `late` ns old; `command` (m,) is the one that was sent last."""
        values = self._known(self._sensors.values(sample))
        broken = not_finite(self._sensors.channels, values, sample.stamp)
        if broken is not None:
            return broken
        self.values = values
        for look in self._looks:
            broken = look(sample.stamp, values, command, late)
            if broken is not None:
                return broken
        return None

    def _known(self, values: list[float]) -> list[float]:
        return [
            value if known(value) or self._sensors.needed(channel) else 0.0
            for channel, value in zip(self._sensors.channels, values, strict=True)
        ]

    @property
    def channels(self) -> list[Channel]:
        """What each value is."""
        return self._sensors.channels
