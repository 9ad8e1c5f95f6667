"""The way of a command through the limits that it is kept within.

    u_d -> k_tot |u_d - x1| <= `force`
        -> s u_d + (1 - s) u_rest          s goes from 0 to 1 over the first `ramp`, and back over the last
        -> |u_d| <= `command`
        -> |du_d/dt| <= `rate`, in real time

Where limits contradict each other, `command` and `rate` are kept and `force` is not. A limit that is absent
changes nothing, and a command within all limits passes unchanged to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.errors import refusal
from rthm_core.slew import Floats, Slew
from rthm_core.spec import LimitsSpec


class Rig(NamedTuple):
    """What has to be known of the m actuators.

    Attributes
    ----------
    stiffness
        k_tot (m,), N/m.
    period
        Period of the commands, ns.
    unloaded
        Gives where the motors (m,) would pull with no force, m.
    """

    stiffness: Floats
    period: int
    unloaded: Callable[[], Floats]


class Limited:
    """How many commands each limit has changed, and which ones changed the present one."""

    def __init__(self) -> None:
        self.counts = {"command": 0, "rate": 0, "force": 0}
        self.now: list[str] = []

    def by(self, limit: str, wanted: Floats, allowed: Floats) -> Floats:
        """Note whether a limit changes what is wanted; return what is allowed."""
        if wanted is not allowed and not np.array_equal(wanted, allowed):
            self.counts[limit] += 1
            self.now.append(limit)
        return allowed


class Shaping:
    """Limits on the commands of m armed actuators.

    Parameters
    ----------
    limits
        Limits of the spec, with their defaults.
    rig
        The actuators.
    rest
        Command (m,) at which the motors stand, m.
    span
        Instants at which commands begin to fade in and have faded out, ns; the latter 0: not known.
    limited
        Where it notes which limit changed a command.

    Raises
    ------
    InputError
        If the motors stand beyond `limits.command`.
    """

    def __init__(
        self, limits: LimitsSpec, rig: Rig, rest: Floats, span: tuple[int, int], limited: Limited
    ) -> None:
        _check(limits, rest)
        self._limits, self._rig, self.rest = limits, rig, rest.copy()
        self._begin, self._end = span
        self._ramp = to_ns(limits.ramp or 0.0)
        self._slew = Slew(limits.rate, rest, rig.period)
        self._limited = limited

    @property
    def last(self) -> Floats:
        """Command (m,) that was sent last."""
        return self._slew.value

    def wanted(self, at: int, u_d: Floats, x1: Floats) -> Floats:
        """What the controller wants at `at`, within the force and faded."""
        return self._faded(at, self._within_force(u_d, x1))

    def sent(self, wanted: Floats, at: int, now: int) -> Floats:
        """What may be sent of it: within the largest command and the rate."""
        limit = self._limits.command
        within = (
            wanted if limit is None else self._limited.by("command", wanted, np.clip(wanted, -limit, limit))
        )
        return self._limited.by("rate", within, self._slew.to(within, at, now))

    def _faded(self, at: int, u_d: Floats) -> Floats:
        if self._ramp == 0:
            return u_d
        left = self._end - at if self._end else self._ramp
        share = max(min(at - self._begin, left, self._ramp), 0) / self._ramp
        return u_d if share == 1.0 else self.rest + share * (u_d - self.rest)

    def _within_force(self, u_d: Floats, x1: Floats) -> Floats:
        if self._limits.force is None:
            return u_d
        reach = self._limits.force / self._rig.stiffness
        return self._limited.by("force", u_d, np.clip(u_d, x1 - reach, x1 + reach))


def _check(limits: LimitsSpec, rest: Floats) -> None:
    furthest = float(np.abs(rest).max())
    if limits.command is not None and not furthest <= limits.command:
        raise refusal(
            "limits.command",
            limits.command,
            f"at least {furthest:.6g} m, where a motor stands before the test",
        )
