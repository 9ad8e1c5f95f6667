"""The plant side's own guard: what it does not execute, whoever commands it.

A command is refused when it is older than `command_age`, not finite, or beyond `command`; what is executed
moves no faster than `rate`, in real time. Once commands have come, a silence longer than `command_age` is
told: the motors then hold where they are.
"""

from __future__ import annotations

import numpy as np

from rthm_core.clock import NS, to_ns
from rthm_core.slew import Floats, Slew
from rthm_core.spec import LimitsSpec


class CommandGuard:
    """Guard of m motors.

    Parameters
    ----------
    limits
        Limits of the spec, with their defaults.
    rest
        Command (m,) before the first one, m.
    period
        Period of the commands, ns.

    Attributes
    ----------
    refused
        How many commands were not executed, by the limit that they broke.
    """

    def __init__(self, limits: LimitsSpec, rest: Floats, period: int) -> None:
        self._largest = limits.command
        self._age = None if limits.command_age is None else to_ns(limits.command_age)
        self._slew = Slew(limits.rate, rest, period)
        self._last: int | None = None
        self._told = False
        self.refused = {"command_age": 0, "finite": 0, "command": 0}

    def executed(self, stamp: int, at: int, command: Floats) -> Floats | None:
        """What a command (m,) with this stamp makes the motors do at `at`, ns; None: nothing."""
        broken = self._broken(stamp, at, command)
        if broken:
            self.refused[broken] += 1
            return None
        self._last, self._told = at, False
        return self._slew.to(command, at, at)

    def silent(self, at: int) -> float | None:
        """How long no command has been executed, s, once it is too long; each silence is told once."""
        if self._age is None or self._last is None or self._told or at - self._last <= self._age:
            return None
        self._told = True
        return (at - self._last) / NS

    def _broken(self, stamp: int, at: int, command: Floats) -> str:
        if self._age is not None and at - stamp > self._age:
            return "command_age"
        if not np.isfinite(command).all():
            return "finite"
        beyond = self._largest is not None and bool((np.abs(command) > self._largest).any())
        return "command" if beyond else ""
