"""What a driver executes: nothing before it is armed, nothing after a silence, and then within limits.

disarmed --- a command within limits.start of the measured motor position ---> armed
armed ------ no command executed for command_age, or two who command --------> disarmed, motors hold
"""

from __future__ import annotations

import numpy as np

from rthm_core.slew import Floats
from rthm_core.spec import LimitsSpec
from rthm_plant_sim.guard import CommandGuard


class Gate:
    """Every command to the motors of a driver passes through it.

    Parameters
    ----------
    limits
        Limits of the spec beside a real machine, with their defaults.
    period
        Period of the commands, ns.

    Attributes
    ----------
    refused
        How many commands were not executed, by the limit that they broke.
    motor
        Newest measured motor positions (m,), m; None: not read yet.
    """

    def __init__(self, limits: LimitsSpec, period: int) -> None:
        assert limits.start is not None
        self._limits, self._period, self._away = limits, period, limits.start[0]
        self._guard: CommandGuard | None = None
        self.refused: dict[str, int] = {"start": 0, "owner": 0}
        self.motor: Floats | None = None

    @property
    def armed(self) -> bool:
        """Whether the motors are under command."""
        return self._guard is not None

    def executed(self, stamp: int, at: int, command: Floats, owners: int = 1) -> Floats | None:
        """What a command (m,) makes the motors do at `at`; None: nothing.

        Parameters
        ----------
        stamp, at
            Instants, ns of the same clock.
        owners
            How many publish commands: with more than one, nobody knows whose this is.
        """
        if owners > 1:
            self._guard = None
            self.refused["owner"] += 1
            return None
        guard = self._guard or self._beginning(command)
        if guard is None:
            self.refused["start"] += 1
            return None
        executed = guard.executed(stamp, at, command)
        if executed is not None:
            self._guard = guard
        self._count(guard)
        return executed

    def why(self, command: Floats, owners: int) -> str:
        """Say why a command was not executed."""
        if owners > 1:
            return f"commands of {owners} nodes: none is executed"
        if self.armed:
            return "a command is refused: too old, not finite, or beyond a limit"
        motor = "are not measured" if self.motor is None else f"stand at {self.motor.round(6).tolist()} m"
        return (
            f"not armed: the motors are commanded to {command.round(6).tolist()} m and {motor}; limits.start"
            f" allows {self._away:g} m, and limits.command_age {self._limits.command_age:g} s"
        )

    def silent(self, at: int) -> float | None:
        """How long no command has been executed, s, once it is too long; the motors are then disarmed."""
        silence = self._guard.silent(at) if self._guard else None
        if silence is not None:
            self._guard = None
        return silence

    def _beginning(self, command: Floats) -> CommandGuard | None:
        """Guard of motors that begin to move from where they stand; None: the command begins elsewhere."""
        if self.motor is None or not np.isfinite(self.motor).all():
            return None
        if (np.abs(command - self.motor) > self._away).any():
            return None
        return CommandGuard(self._limits, self.motor, self._period)

    def _count(self, guard: CommandGuard) -> None:
        for name, count in guard.refused.items():
            self.refused[name] = self.refused.get(name, 0) + count
            guard.refused[name] = 0
