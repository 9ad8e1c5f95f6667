"""Supervision of what a rig measures: small watchers that look at each sample, or at each command.

A watcher knows no time but what it is told, and answers with what is broken, or with None.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rthm_actuator.sensors import FORCE, MOTOR, POSITION, VELOCITY, Channel, known
from rthm_core.clock import NS
from rthm_core.slew import Floats

MEASURED = {"position": POSITION, "velocity": VELOCITY, "measured_force": FORCE}
"""Kind of channel that each of these limits is for."""


class Broken(NamedTuple):
    """A limit that is broken: its name, the figures, and what happened in words.

    Attributes
    ----------
    bad
        Kinds of sensor that cannot be relied upon any more.
    """

    limit: str
    value: float | None
    allowed: float | None
    words: str
    bad: tuple[str, ...] = ()


def not_finite(channels: Sequence[Channel], values: Sequence[float], at: int) -> Broken | None:
    """Tell a sensor that gives no number."""
    for channel, value in zip(channels, values, strict=True):
        if not known(value):
            reading = "not a number" if value != value else "infinity"
            words = f"{channel.words} reads {reading} since {at / NS:.3f} s"
            return Broken("finite", value, None, words, (channel.kind,))
    return None


class Step:
    """Largest step of a measured position, or motor position, between two samples.

    Parameters
    ----------
    channels
        What each value of a sample is.
    limit, period
        Largest step (m) between samples one period (ns) apart; in longer gaps it grows with the time.
    commands
        Period of the commands, ns: a motor may go at once as far as they step.
    """

    def __init__(self, channels: Sequence[Channel], limit: float, period: int, commands: int = 0) -> None:
        self._watched = [i for i, channel in enumerate(channels) if channel.kind in (POSITION, MOTOR)]
        self._channels, self._limit, self._period, self._commands = channels, limit, period, commands
        self._last: tuple[int, Sequence[float]] | None = None

    def look(self, stamp: int, values: Sequence[float]) -> Broken | None:
        """Compare a sample with the one before; one with an older stamp is none."""
        if self._last is not None and stamp <= self._last[0]:
            return None
        before, self._last = self._last, (stamp, values)
        if before is None:
            return None
        for i in self._watched:
            step = abs(values[i] - before[1][i])
            apart = max(stamp - before[0], self._commands if self._channels[i].kind == MOTOR else 0)
            allowed = self._limit * max(apart / self._period, 1.0)
            if step > allowed:
                channel = self._channels[i]
                words = f"{channel.words} steps by {step:.6g} m in one sample, allowed is {allowed:.6g} m"
                return Broken("step", step, allowed, words, (channel.kind,))
        return None


class Frozen:
    """A sensor that does not change in any digit while the command moves.

    Parameters
    ----------
    channels
        What each value of a sample is.
    limit
        How long it may do so, ns.
    travel
        How far the command must have gone meanwhile, m: a sensor with coarse digits may stand for less.
    """

    def __init__(self, channels: Sequence[Channel], limit: int, travel: float) -> None:
        self._channels, self._limit, self._travel = channels, limit, travel
        self._values: list[float] = []
        self._since: list[tuple[int, Floats]] = []

    def look(self, stamp: int, values: Sequence[float], command: Floats, late: int = 0) -> Broken | None:
        """Look at a sample; `command` (m,) is the one that was sent last.

        A sample that comes `late` (ns), as after a stall, knows nothing of the commands since.
        """
        if late > self._limit // 2:
            self._values = []
        if len(self._values) != len(values):
            self._values, self._since = list(values), [(stamp, command)] * len(values)
        for i, value in enumerate(values):
            if value != self._values[i]:
                self._values[i], self._since[i] = value, (stamp, command)
            elif stamp - self._since[i][0] > self._limit and self._moved(i, command):
                return self._broken(i, stamp - self._since[i][0])
        return None

    def _moved(self, i: int, command: Floats) -> bool:
        return bool(np.abs(command - self._since[i][1]).max() > self._travel)

    def _broken(self, i: int, stood: int) -> Broken:
        channel, seconds, allowed = self._channels[i], stood / NS, self._limit / NS
        reading = f"{self._values[i]:.6g} {channel.unit} for {seconds:.3f} s"
        words = f"{channel.words} has read {reading} while the command moved"
        return Broken("frozen", seconds, allowed, words, (channel.kind,))


class Largest:
    """Largest measured position, velocity and force, either way.

    Parameters
    ----------
    channels
        What each value of a sample is.
    limits
        Of each key of `MEASURED`, in its unit; None: any.
    """

    def __init__(self, channels: Sequence[Channel], limits: Mapping[str, float | None]) -> None:
        self._watched = [
            (i, channel, name, limit)
            for name, limit in limits.items()
            for i, channel in enumerate(channels)
            if limit is not None and channel.kind == MEASURED[name]
        ]

    def look(self, values: Sequence[float]) -> Broken | None:
        """Look at a sample."""
        for i, channel, name, limit in self._watched:
            if abs(values[i]) > limit:
                unit = channel.unit
                words = f"{channel.words} reads {values[i]:.6g} {unit}, allowed is {limit:g} {unit}"
                return Broken(name, abs(values[i]), limit, words)
        return None


class Following:
    """Distance of the motors from their commands.

    Parameters
    ----------
    names
        Of the actuators.
    limit
        Largest distance, m.
    """

    def __init__(self, names: Sequence[str], limit: float) -> None:
        self._names, self._limit = names, limit

    def look(self, motors: Sequence[float], command: Floats) -> Broken | None:
        """Compare the motors (m,) with the command (m,) that was sent last."""
        for name, motor, wanted in zip(self._names, motors, command.tolist(), strict=True):
            error = abs(motor - wanted)
            if error > self._limit:
                words = f"the motor of {name} is {error:.6g} m off its command, allowed is {self._limit:g} m"
                return Broken("following", error, self._limit, words)
        return None
