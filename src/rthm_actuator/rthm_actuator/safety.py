"""The safety monitor: nothing goes to an actuator but through it.

    u_d -> k_tot |u_d - x1| <= `force`
        -> s u_d + (1 - s) u_rest          s goes from 0 to 1 over the first `ramp`, and back over the last
        -> |u_d| <= `command`
        -> |du_d/dt| <= `rate`, in real time -> actuator/command

`u_rest` is where the motors stand before the test: as the spec says, or as it was measured when the rig was
armed. Where limits contradict each other, `command` and `rate` are kept and `force` is not. The first limit
that is broken ends the test: the motors go back to `u_rest` over `ramp` at once, or where `on_abort` says,
and stay there until the next test. It never raises on what it is given. A limit that is absent changes
nothing, and a command within all limits passes unchanged to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from rthm_actuator.overdue import Age, Hold
from rthm_actuator.supervision import Broken
from rthm_actuator.way_back import HOLD, NEEDED, RETURN, UNLOAD, WayBack
from rthm_core.clock import NS, to_ns
from rthm_core.errors import InputError, refusal
from rthm_core.events import Abort
from rthm_core.slew import Floats, Slew
from rthm_core.spec import LimitsSpec


class Expected(NamedTuple):
    """When an input gives samples: the first one, and the longest time between two, both ns.

    Attributes
    ----------
    sensors
        Kinds of sensor that come with it.
    """

    first: int
    period: int
    sensors: tuple[str, ...] = ()


class Rig(NamedTuple):
    """What the monitor has to know of the m actuators.

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


class SafetyMonitor:
    """Safety monitor of m actuators; until it is armed it gives no command.

    Parameters
    ----------
    limits
        Limits of the spec, with their defaults.
    rig
        The actuators.
    inputs
        Inputs of the controller that have to stay fresh.
    end
        End of the test, at which the motors are back at rest, ns; 0: not known.

    Attributes
    ----------
    abort
        Why the test was ended; None while it was not.
    reason
        The same in words, also when it was only stopped; empty while it was not.
    limited
        How many commands each limit has changed.

    Raises
    ------
    InputError
        If the limits cannot be kept at all.
    """

    def __init__(self, limits: LimitsSpec, rig: Rig, inputs: Mapping[str, Expected], end: int = 0) -> None:
        _check(limits, inputs)
        self.limits, self._rig, self._end = limits, rig, end
        stale, age = _ns(limits.stale), _ns(limits.age)
        self._ages = {name: Age(name, one.first, stale, age, one.sensors) for name, one in inputs.items()}
        self._hold = None if limits.hold is None else Hold(to_ns(limits.hold))
        self._ramp = to_ns(limits.ramp or 0.0)
        self._slew: Slew | None = None
        self._way: WayBack | None = None
        self._touched: list[str] = []
        self.abort: Abort | None = None
        self.reason = ""
        self.limited = {"command": 0, "rate": 0, "force": 0}

    def arm(self, rest: Floats, at: int = 0) -> None:
        """Let commands begin at `rest` (m,), where the motors stand, at the instant `at`.

        Raises
        ------
        InputError
            If they stand beyond `limits.command`.
        """
        _check_rest(self.limits, rest)
        self._rest, self._begin = rest.copy(), at
        self._slew = Slew(self.limits.rate, rest, self._rig.period)

    @property
    def armed(self) -> bool:
        """Whether commands are given."""
        return self._slew is not None

    @property
    def last(self) -> Floats:
        """Command (m,) that was given last."""
        assert self._slew is not None
        return self._slew.value

    @property
    def at_rest(self) -> bool:
        """Whether the motors have been sent to where they stay after the test."""
        if self._slew is None:
            return True
        if self._way is not None:
            return self._way.over(self._slew.value)
        return bool(np.array_equal(self._slew.value, self._rest))

    def heard(self, name: str, stamp: int, now: int) -> None:
        """Look at the stamp of a sample of an input that has arrived."""
        self.judge(now, self._ages[name].heard(stamp, now))

    def accept(self, name: str, stamp: int, now: int, *values: Floats) -> bool:
        """Look at a sample that the controller is about to use; whether it may."""
        if not all(np.isfinite(value).all() for value in values):
            self.judge(now, Broken("finite", None, None, f"{name} is not finite"))
            return False
        self._ages[name].used(stamp, now)
        return True

    def reference(self, force: Floats) -> Floats:
        """F_d (m,) within the limit."""
        limit = self.limits.force
        return force if limit is None else self._counted("force", force, np.clip(force, -limit, limit))

    def command(self, at: int, now: int, u_d: Floats, x1: Floats) -> Floats | None:
        """Command (m,) that may be sent; None: none may.

        Parameters
        ----------
        at, now
            Instant to which the command belongs, and the present, ns after the start; never earlier than in
            the last call.
        u_d, x1
            Command (m,) that the controller wants, and where it sees the plant, m.
        """
        self._judge_inputs(now, u_d)
        if self._slew is None:
            return None
        self._touched = []
        way = self._way
        wanted = way.at(now) if way else self._faded(at, self._within_force(u_d, x1))
        within = self._within_travel(wanted)
        sent = self._counted("rate", within, self._slew.to(within, at, now))
        if self._hold is not None and self._way is None:
            self.judge(now, self._hold.look(now, self._touched))
        return sent

    def judge(self, at: int, broken: Broken | None) -> None:
        """End the test if something is broken; what was broken first is told."""
        if broken is None:
            return
        if not self.reason:
            self.abort = Abort(at / NS, *broken[:4])
            self._leave(at, self.abort.words, self.limits.on_abort)
        self._lose(at, broken.bad)

    def obey(self, at: int, abort: Abort) -> None:
        """End the test because somebody else says so."""
        if not self.reason:
            self.abort = abort
            self._leave(at, abort.words, self.limits.on_abort)

    def stop(self, at: int, reason: str) -> None:
        """Go back to rest from now on, without an abort."""
        self._leave(at, reason, RETURN)

    def _leave(self, at: int, reason: str, way: str) -> None:
        if self.reason:
            return
        self.reason, self._kind = reason, way
        if self._slew is not None:
            ramp = 0 if way == HOLD else self._ramp
            target = self._rig.unloaded if way == UNLOAD else self._where_it_stood
            self._way = WayBack(at, self._slew.value, ramp, target)

    def _lose(self, at: int, bad: tuple[str, ...]) -> None:
        """Stay where the motors are when a sensor is lost without which the way back cannot be gone."""
        if self._way is not None and set(bad) & set(NEEDED[self._kind]):
            self._kind = HOLD
            self._way = WayBack(at, self.last, 0, self._where_it_stood)

    def _where_it_stood(self) -> Floats:
        return self._rest

    def _judge_inputs(self, now: int, u_d: Floats) -> None:
        if not np.isfinite(u_d).all():
            self.judge(now, Broken("finite", None, None, "the command is not finite"))
        for age in self._ages.values():
            self.judge(now, age.look(now))

    def _faded(self, at: int, u_d: Floats) -> Floats:
        if self._ramp == 0:
            return u_d
        left = self._end - at if self._end else self._ramp
        share = max(min(at - self._begin, left, self._ramp), 0) / self._ramp
        return u_d if share == 1.0 else self._rest + share * (u_d - self._rest)

    def _within_force(self, u_d: Floats, x1: Floats) -> Floats:
        if self.limits.force is None:
            return u_d
        reach = self.limits.force / self._rig.stiffness
        return self._counted("force", u_d, np.clip(u_d, x1 - reach, x1 + reach))

    def _within_travel(self, u_d: Floats) -> Floats:
        limit = self.limits.command
        return u_d if limit is None else self._counted("command", u_d, np.clip(u_d, -limit, limit))

    def _counted(self, limit: str, wanted: Floats, allowed: Floats) -> Floats:
        if wanted is not allowed and not np.array_equal(wanted, allowed):
            self.limited[limit] += 1
            self._touched.append(limit)
        return allowed


def _ns(seconds: float | None) -> int | None:
    return None if seconds is None else to_ns(seconds)


def _check_rest(limits: LimitsSpec, rest: Floats) -> None:
    furthest = float(np.abs(rest).max())
    if limits.command is not None and not furthest <= limits.command:
        raise refusal(
            "limits.command",
            limits.command,
            f"at least {furthest:.6g} m, where a motor stands before the test",
        )


def _check(limits: LimitsSpec, inputs: Mapping[str, Expected]) -> None:
    for name, expected in inputs.items():
        for key, least in (("stale", expected.period), ("age", expected.first + expected.period)):
            limit = getattr(limits, key)
            if limit is not None and to_ns(limit) <= least:
                what = "the period" if key == "stale" else "the delay and the period"
                raise InputError(
                    f"limits.{key} is {limit!r}, but must be longer than {what} of {name}, {least / NS:g} s;"
                    " raise it."
                )
