"""The safety monitor: nothing goes to an actuator but through it.

    u_d -> k_tot |u_d - x1| <= `force`
        -> s u_d + (1 - s) u_rest          s goes from 0 to 1 over the first `ramp`, and back over the last
        -> |u_d| <= `command`
        -> |du_d/dt| <= `rate` -> actuator/command

`u_rest` is the command before the test, at which the motors stand. Where limits contradict each other,
`command` and `rate` are kept and `force` is not. A number that is not finite, or an input without a
fresh sample for `stale`, trips the monitor: it holds the last command for `stale`, then goes back to
`u_rest` over `ramp` (without `ramp` it holds the command), and stays there until the next test. It never
raises on what it is given. A limit that is absent changes nothing, and a command within all limits
passes unchanged to the last bit.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rthm_core.clock import NS, to_ns
from rthm_core.errors import InputError, refusal
from rthm_core.spec import LimitsSpec

Floats = NDArray[np.float64]


class Expected(NamedTuple):
    """When an input gives samples: the first one, and the longest time between two, both ns."""

    first: int
    period: int


class SafetyMonitor:
    """Safety monitor of m actuators.

    Parameters
    ----------
    limits
        Limits of the spec; None: none.
    rest
        Command (m,) at which the motors stand before and after a test, m.
    stiffness
        k_tot (m,), N/m.
    inputs
        Inputs of the controller that have to stay fresh.
    end
        End of the test, at which the motors are back at rest, ns; 0: not known.

    Attributes
    ----------
    reason
        Why the monitor has tripped or was stopped; empty while it has not.
    limited
        How many commands each limit has changed.

    Raises
    ------
    InputError
        If the limits cannot be kept at all.
    """

    def __init__(
        self,
        limits: LimitsSpec | None,
        rest: Floats,
        stiffness: Floats,
        inputs: Mapping[str, Expected],
        end: int = 0,
    ) -> None:
        self.limits = limits or LimitsSpec()
        _check(self.limits, rest, inputs)
        self._rest, self._stiffness, self._end = rest.copy(), stiffness.copy(), end
        self._fresh = {name: expected.first for name, expected in inputs.items()}
        self._last, self._at = rest.copy(), 0
        self._stopped, self._hold = 0, 0
        self._ramp = to_ns(self.limits.ramp or 0.0)
        self._stale = None if self.limits.stale is None else to_ns(self.limits.stale)
        self.reason = ""
        self.limited = {"command": 0, "rate": 0, "force": 0}

    @property
    def at_rest(self) -> bool:
        """Whether the motors have been sent back to where they stood before the test."""
        return bool(np.array_equal(self._last, self._rest))

    def accept(self, name: str, at: int, *values: Floats) -> bool:
        """Look at a new sample of an input at the instant `at`; whether the controller may use it."""
        if not all(np.isfinite(value).all() for value in values):
            self.trip(at, f"{name} is not finite")
            return False
        self._fresh[name] = at
        return True

    def reference(self, force: Floats) -> Floats:
        """F_d (m,) within the limit."""
        limit = self.limits.force
        return force if limit is None else self._counted("force", force, np.clip(force, -limit, limit))

    def command(self, at: int, u_d: Floats, x1: Floats) -> Floats:
        """Command (m,) that may be sent at the instant `at`.

        Parameters
        ----------
        at
            Instant, ns after the start; never earlier than in the last call.
        u_d, x1
            Command (m,) that the controller wants, and where it sees the plant, m.
        """
        self._judge(at, u_d)
        target = self._way_back(at) if self.reason else self._faded(at, self._within_force(u_d, x1))
        self._last, self._at = self._within_rate(at, self._within_travel(target)), at
        return self._last

    def trip(self, at: int, reason: str) -> None:
        """Stop for a fault: hold the command, then go back to rest."""
        self.stop(at, reason, hold=self._stale or 0)

    def stop(self, at: int, reason: str, hold: int = 0) -> None:
        """Go back to rest from now on; what stopped the monitor first counts."""
        if not self.reason:
            self.reason, self._stopped, self._hold = reason, at, hold
            self._held = self._last.copy()

    def _judge(self, at: int, u_d: Floats) -> None:
        if not np.isfinite(u_d).all():
            self.trip(at, "the command is not finite")
        if self._stale is None:
            return
        for name, fresh in self._fresh.items():
            if at - fresh > self._stale:
                self.trip(at, f"{name} has had no fresh sample for {(at - fresh) / NS:.3f} s")

    def _way_back(self, at: int) -> Floats:
        waited = at - self._stopped - self._hold
        if self._ramp == 0 or waited <= 0:
            return self._held
        if waited >= self._ramp:
            return self._rest
        return self._held + (self._rest - self._held) * (waited / self._ramp)

    def _faded(self, at: int, u_d: Floats) -> Floats:
        if self._ramp == 0:
            return u_d
        left = self._end - at if self._end else self._ramp
        share = max(min(at, left, self._ramp), 0) / self._ramp
        return u_d if share == 1.0 else self._rest + share * (u_d - self._rest)

    def _within_force(self, u_d: Floats, x1: Floats) -> Floats:
        if self.limits.force is None:
            return u_d
        reach = self.limits.force / self._stiffness
        return self._counted("force", u_d, np.clip(u_d, x1 - reach, x1 + reach))

    def _within_travel(self, u_d: Floats) -> Floats:
        limit = self.limits.command
        return u_d if limit is None else self._counted("command", u_d, np.clip(u_d, -limit, limit))

    def _within_rate(self, at: int, u_d: Floats) -> Floats:
        if self.limits.rate is None:
            return u_d
        step = self.limits.rate * ((at - self._at) / NS)
        return self._counted("rate", u_d, np.clip(u_d, self._last - step, self._last + step))

    def _counted(self, limit: str, wanted: Floats, allowed: Floats) -> Floats:
        self.limited[limit] += not np.array_equal(wanted, allowed)
        return allowed


def _check(limits: LimitsSpec, rest: Floats, inputs: Mapping[str, Expected]) -> None:
    furthest = float(np.abs(rest).max())
    if limits.command is not None and furthest > limits.command:
        raise refusal(
            "limits.command",
            limits.command,
            f"at least {furthest:.6g} m, where a motor stands before the test",
        )
    for name, expected in inputs.items():
        if limits.stale is not None and to_ns(limits.stale) <= expected.period:
            raise InputError(
                f"limits.stale is {limits.stale!r}, but must be longer than the period of {name}, "
                f"{expected.period / NS:g} s; raise it."
            )
