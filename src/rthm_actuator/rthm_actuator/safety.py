"""The safety monitor: nothing goes to an actuator but through it (`rthm_actuator.shaping`).

Commands begin where the motors stand before the test: as the spec says, or as it was measured when the rig
was armed. The first limit that is broken ends the test: at once the motors go back there over `ramp`, or
where `on_abort` says, and stay until the next test. It never raises on what it is given.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from rthm_actuator.overdue import Age, Hold
from rthm_actuator.shaping import Limited, Rig, Shaping
from rthm_actuator.supervision import Broken
from rthm_actuator.way_back import HOLD, NEEDED, RETURN, UNLOAD, WayBack
from rthm_core.clock import NS, to_ns
from rthm_core.errors import InputError
from rthm_core.events import Abort
from rthm_core.slew import Floats
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

    Raises
    ------
    InputError
        If the limits cannot be kept at all.
    """

    def __init__(self, limits: LimitsSpec, rig: Rig, inputs: Mapping[str, Expected], end: int = 0) -> None:
        _check(limits, inputs)
        self._limits, self._rig, self._end = limits, rig, end
        stale, age = _ns(limits.stale), _ns(limits.age)
        self._ages = {name: Age(name, one.first, stale, age, one.sensors) for name, one in inputs.items()}
        self._hold = None if limits.hold is None else Hold(to_ns(limits.hold))
        self._limited = Limited()
        self._shaping: Shaping | None = None
        self._way: WayBack | None = None
        self.abort: Abort | None = None
        self.reason = ""

    def arm(self, rest: Floats, at: int = 0) -> None:
        """Let commands begin at `rest` (m,), where the motors stand, at the instant `at`.

        Raises
        ------
        InputError
            If they stand beyond `limits.command`.
        """
        self._shaping = Shaping(self._limits, self._rig, rest, (at, self._end), self._limited)

    @property
    def armed(self) -> bool:
        """Whether commands are given."""
        return self._shaping is not None

    @property
    def last(self) -> Floats:
        """Command (m,) that was given last."""
        assert self._shaping is not None
        return self._shaping.last

    @property
    def limited(self) -> dict[str, int]:
        """How many commands each limit has changed."""
        return self._limited.counts

    @property
    def at_rest(self) -> bool:
        """Whether the motors have been sent to where they stay after the test."""
        if self._shaping is None:
            return True
        if self._way is not None:
            return self._way.over(self._shaping.last)
        return bool(np.array_equal(self._shaping.last, self._shaping.rest))

    def heard(self, name: str, stamp: int, now: int) -> None:
        """Look at the stamp of a sample of an input that has arrived."""
        self.judge(now, self._ages[name].heard(stamp, now))

    def unread(self, name: str, why: str) -> None:
        """Note what is wrong with a message of an input that cannot be used."""
        self._ages[name].unread(why)

    def accept(self, name: str, stamp: int, now: int, *values: Floats) -> bool:
        """Look at a sample that the controller is about to use; whether it may."""
        if not all(np.isfinite(value).all() for value in values):
            self.judge(now, Broken("finite", None, None, f"{name} is not finite"))
            return False
        self._ages[name].used(stamp, now)
        return True

    def reference(self, force: Floats) -> Floats:
        """F_d (m,) within the limit."""
        limit = self._limits.force
        return force if limit is None else self._limited.by("force", force, np.clip(force, -limit, limit))

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
        if self._shaping is None:
            return None
        self._limited.now = []
        wanted = self._way.at(now) if self._way else self._shaping.wanted(at, u_d, x1)
        sent = self._shaping.sent(wanted, at, now)
        if self._hold is not None and self._way is None:
            self.judge(now, self._hold.look(now, self._limited.now))
        return sent

    def judge(self, at: int, broken: Broken | None) -> None:
        """End the test if something is broken; what was broken first is told."""
        if broken is None:
            return
        if not self.reason:
            self.abort = Abort(at / NS, *broken[:4])
            self._leave(at, self.abort.words, self._limits.on_abort)
        self._lose(at, broken.bad)

    def obey(self, at: int, abort: Abort) -> None:
        """End the test because somebody else says so."""
        if not self.reason:
            self.abort = abort
            self._leave(at, abort.words, self._limits.on_abort)

    def stop(self, at: int, reason: str) -> None:
        """Go back to rest from now on, without an abort."""
        if not self.reason:
            self._leave(at, reason, RETURN)

    def _leave(self, at: int, reason: str, way: str) -> None:
        self.reason, self._kind = reason, way
        if self._shaping is not None:
            rest = self._shaping.rest
            ramp = 0 if way == HOLD else to_ns(self._limits.ramp or 0.0)
            target = self._rig.unloaded if way == UNLOAD else lambda: rest
            self._way = WayBack(at, self.last, ramp, target)

    def _lose(self, at: int, bad: tuple[str, ...]) -> None:
        """Stay where the motors are when a sensor is lost without which the way back cannot be gone."""
        if self._way is not None and set(bad) & set(NEEDED[self._kind]):
            self._leave(at, self.reason, HOLD)

    def _judge_inputs(self, now: int, u_d: Floats) -> None:
        if not np.isfinite(u_d).all():
            self.judge(now, Broken("finite", None, None, "the command is not finite"))
        for age in self._ages.values():
            self.judge(now, age.look(now))


def _ns(seconds: float | None) -> int | None:
    return None if seconds is None else to_ns(seconds)


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
