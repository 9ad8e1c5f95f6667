"""Where the motors go after an abort: back to where they stood, nowhere, or to where nothing pulls."""

from __future__ import annotations

from collections.abc import Callable

from rthm_actuator.sensors import FORCE, MOTOR
from rthm_core.slew import Floats

RETURN, HOLD, UNLOAD = "return", "hold", "unload"
NEEDED = {RETURN: (), HOLD: (), UNLOAD: (MOTOR, FORCE)}
"""Kinds of sensor without which a way back cannot be gone."""


class WayBack:
    """Ramp from the command at the abort to where the motors come to rest.

    Parameters
    ----------
    begin
        Instant of the abort, ns.
    held
        Command (m,) at the abort, m.
    ramp
        How long the way takes, ns; 0: none is gone.
    target
        Gives the place of rest (m,); asked until the ramp is over.
    """

    def __init__(self, begin: int, held: Floats, ramp: int, target: Callable[[], Floats]) -> None:
        self._begin, self._held, self._ramp, self._target = begin, held.copy(), ramp, target
        self._rest = held.copy() if ramp == 0 else None

    def at(self, at: int) -> Floats:
        """Command (m,) at the instant `at`, ns."""
        if self._rest is not None:
            return self._rest
        share = (at - self._begin) / self._ramp
        if share >= 1.0:
            self._rest = self._target().copy()
            return self._rest
        return self._held + (self._target() - self._held) * max(share, 0.0)

    def over(self, command: Floats) -> bool:
        """Whether the way ends at this command."""
        return self._rest is not None and bool((command == self._rest).all())
