"""The device's side: answers requests, and executes commands that are fresh, near and within limits.

The same rules are in examples/udp_device.c, in C99. The device has a clock of its own and needs no other: a
request has the device's time of the newest state that the host had when it made the command. A command that
echoes a time further back than `command_age` is old, wherever it was delayed, and is not executed. Without a
fresh one for `command_age` the motors hold, and the next one must begin where they stand.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rthm_plant_sim.udp.packets import ARMED, BAD, FAR, MODULUS, OLD, Request, State, ahead, read_request

Values = Sequence[float]
Sensors = Callable[[], tuple[Values, Values, Values, Values]]
"""Gives positions and velocities of the dofs, positions and forces of the actuators."""


@dataclass(frozen=True)
class DeviceLimits:
    """A device's own limits, whatever a host says.

    Attributes
    ----------
    command, rate
        Largest command, m, and its largest rate, m/s.
    start
        Largest distance of the first command from the motors, m.
    command_age
        Largest age of a command, and longest time without one, us.
    period
        Longest time that counts for the rate, us.
    """

    command: float
    rate: float
    start: float
    command_age: int
    period: int


class DeviceLogic:
    """What a device does with packets; it has no socket and no clock. Times are us of 32 bits.

    Parameters
    ----------
    limits
        Its own.
    dofs, actuators
        Numbers n and m.
    sensors
        Reads the sensors.

    Attributes
    ----------
    command
        What the motors are to do (m,), m; None: hold.
    armed
        Whether the motors are under command.
    """

    def __init__(self, limits: DeviceLimits, dofs: int, actuators: int, sensors: Sensors) -> None:
        self._limits, self._sizes, self._sensors = limits, (dofs, actuators), sensors
        self._session = self._heard = self._number = self._fresh = 0
        self.command: list[float] | None = None
        self.armed = False

    def receive(self, packet: bytes, now: int) -> bytes | None:
        """Take a packet; return the answer, None where none is owed."""
        self.watch(now)
        try:
            request = read_request(packet)
        except ValueError:
            return None
        if (request.dofs, len(request.command)) != self._sizes or not self._continues(request):
            return None
        position, velocity, motor, force = self._sensors()
        refused = self._obey(request, now, motor) if request.commanded else 0
        self._number = self._number % (MODULUS - 1) + 1
        flags = refused | (ARMED if self.armed else 0)
        head = (self._session, self._number, request.number, now % MODULUS, flags)
        return State(*head, position, velocity, motor, force).packet()

    def watch(self, now: int) -> bool:
        """Hold where no fresh command has come for too long; whether that is found now."""
        if not self.armed or _since(self._fresh, now) <= self._limits.command_age:
            return False
        self.armed, self.command = False, None
        return True

    def _continues(self, request: Request) -> bool:
        """Whether a request goes on with the session, or begins one while nobody commands the motors."""
        if request.session != self._session:
            if self.armed:
                return False
            self._session = request.session
        elif ahead(request.number, self._heard) <= 0:
            return False
        self._heard = request.number
        return True

    def _obey(self, request: Request, now: int, motor: Values) -> int:
        """Execute a command as far as is allowed; 0, or the flag that says why not."""
        limits, pairs = self._limits, list(zip(request.command, motor, strict=True))
        if _since(request.time, now) > limits.command_age:
            return OLD
        if not all(abs(u) <= limits.command for u in request.command):  # a NaN is not, either
            return BAD
        if not self.armed and not all(abs(u - at) <= limits.start for u, at in pairs):
            return FAR
        passed = min(_since(self._fresh, now), limits.period) if self.armed else limits.period
        step = limits.rate * passed * 1e-6
        last = motor if self.command is None else self.command
        self.command = [
            at + math.copysign(min(abs(u - at), step), u - at)
            for u, at in zip(request.command, last, strict=True)
        ]
        self.armed, self._fresh = True, now
        return 0


def _since(time: int, now: int) -> int:
    return (now - time) % MODULUS
