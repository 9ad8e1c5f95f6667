"""Node ``driver``: a device as the plant of tests, whatever tests come and go.

It publishes ``plant/state`` of its own accord, on a grid of Td1 that begins with it, and executes
``actuator/command`` when tau4 is over, as far as the gate lets it (`rthm_plant_sim.driver.gate`).
"""

from __future__ import annotations

import time

import numpy as np
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from rthm_core.clock import NS, Rank, to_ns
from rthm_core.limits import kept_limits
from rthm_core.link import Link
from rthm_core.ros import system
from rthm_core.ros.agenda import Agenda, Position
from rthm_core.ros.comparing import Clock
from rthm_core.ros.diagnostics import ERROR, OK, Diagnostics
from rthm_core.ros.ports import Input, Ports
from rthm_core.ros.qos import samples
from rthm_core.ros.realtime import RealTime
from rthm_core.ros.wall import wall_ns
from rthm_core.spec import Spec
from rthm_core.topics import COMMAND, NAMESPACE, PLANT_STATE
from rthm_plant_sim.driver.device import Device, Layout, Reading
from rthm_plant_sim.driver.gate import Gate
from rthm_plant_sim.driver.grid import Grid, longest_pause
from rthm_plant_sim.driver.telling import Teller
from rthm_plant_sim.driver.zero import SECTION, WORDS, Zero

DRIVER_PRIORITY = 49
"""Real-time priority that is asked for: that of the simulated plant."""
MARGIN = 100_000
"""Time before a tick in which the clock is watched without sleep, ns."""
LOOK = NS // 20
"""Period at which publishers of commands are counted, ns."""


class DriverNode(Node):  # type: ignore[misc]
    """Samples a device every Td1, and commands it.

    Parameters
    ----------
    device, spec, dead_time
        As for `rthm_plant_sim.driver.drive`.
    polled
        Whether the device is read every Td1; a device that is not calls `publish` by itself.

    Raises
    ------
    InputError
        When the spec is no complete loop, or has not all limits of a real machine.
    """

    def __init__(self, device: Device, spec: Spec, dead_time: float = 0.0, polled: bool = True) -> None:
        self._layout, timing = Layout(spec), spec.loop().timing
        self.limits = kept_limits(spec, hardware=True)
        super().__init__("driver", namespace=NAMESPACE)
        self.device, self._polled = device, polled
        self._period, self._dead = timing.ns("td1"), to_ns(dead_time)
        self._grid = Grid(self._period, longest_pause(self.limits, self._period))
        self.gate = Gate(self.limits, timing.ns("td3"))
        self.ports = Ports(self, samples())
        self._state = self.ports.output(PLANT_STATE, (*self._layout.dofs, *self._layout.actuators))
        link = Link(spec.model_copy(update={"effects": ()}), "tau4")
        link.delay_ns = max(link.delay_ns - self._dead, 0)
        self._commands = self.ports.input(COMMAND, self._layout.actuators, link)
        self._diagnostics = Diagnostics(self)
        self._compared = Clock(self, lambda: self._wall_ns() - time.time_ns())
        self._agenda = Agenda()
        self._offer(self._layout.zero)
        self._loop: RealTime | None = None
        self._owners, self._seen, self._quiet, self._unread = 1, 0, 0, 0
        self._teller = Teller(self.get_logger().warning)
        self._next_report = 0

    def turn(self) -> bool:
        """Do what is next; return whether now is a good moment for work that can wait."""
        if self._loop is None:
            self._loop = self._begun()
        return self._loop.turn()

    def next(self) -> Position:
        """Place of what is next, ns of the wall clock."""
        at, rank = self._agenda.next()
        return Position(at + (self.ports.start or 0), rank)

    def attend(self) -> None:
        """Tell how it is, once a second."""
        self._report()

    def stop(self) -> None:
        """End: the motors hold, and the device is let go."""
        self._tell_device("hold")
        self._tell_device("close")

    def publish(self, reading: Reading) -> None:
        """Publish a reading that has a stamp of its own."""
        values = self._layout.values(reading)
        self.gate.motor = self._layout.motor(values)
        self._state.send((reading.stamp or 0) - (self.ports.start or 0), *values)

    def _offer(self, zero: Zero) -> None:
        """Let the leader of a test say what is subtracted from the readings, while nothing moves."""
        for name, values in zero.values.items():
            self.declare_parameter(
                f"{SECTION}.{name}", values.tolist(), ParameterDescriptor(description=WORDS)
            )

        def take(changes: list[Parameter]) -> SetParametersResult:
            told = {one.name.partition(".")[2]: one.value for one in changes if one.name.startswith(SECTION)}
            reason = "the motors are under command" if told and self.gate.armed else zero.taken(told)
            return SetParametersResult(successful=not reason, reason=reason)

        self.add_on_set_parameters_callback(take)

    def _wall_ns(self) -> int:
        return self._loop.wall_ns() if self._loop else wall_ns()

    def _begun(self) -> RealTime:
        """Begin the grid at the next full Td1 of the wall clock."""
        reading = self._read() if self._polled else None
        if reading is not None:
            self._layout.values(reading)
        system.prepare(DRIVER_PRIORITY, lock_memory=True)
        system.hold_garbage()
        self.ports.start = (wall_ns() // self._period + 2) * self._period
        self.ports.listening = self.ports.speaking = True
        self._agenda.when_due(_Waiting(self._commands), self._receive)
        if self._polled:
            self._agenda.every("Td1", self._period, Rank.SAMPLE, self._sample, skips=True)
        self._agenda.every("watch", LOOK, Rank.CONTROL, self._watch, skips=True)
        loop = RealTime(self.executor, self._agenda, self.ports, MARGIN)
        self.ports.now = loop.now
        return loop

    def _sample(self, at: int, now: int) -> None:
        reading = self._read()
        if reading is None:
            self._unread += 1
            self.gate.motor = None  # nothing is armed by where the motors stood some time ago
            return
        if reading.stamp is not None:
            self.publish(reading)
            return
        values = self._layout.values(reading)
        self.gate.motor = self._layout.motor(values)
        for stamp, sample in self._grid.samples(at, (now + self.ports.now()) // 2, values):
            self._state.send(stamp, *sample)

    def _read(self) -> Reading | None:
        try:
            reading = self.device.read()
        except OSError as error:
            self._teller.say(f"the device cannot be read: {error}")
            return None
        if reading is None or isinstance(reading, Reading):
            return reading
        position, velocity, motor, force = reading
        return Reading(position, velocity, motor, force)

    def _receive(self, at: int, now: int) -> None:
        command = self._commands.take(at)
        if command is None:
            return
        wanted, armed = np.array(command.position), self.gate.armed
        executed = self.gate.executed(command.stamp, now, wanted, self._owners)
        if executed is None:
            self._teller.say(self.gate.why(wanted, self._owners))
            return
        if not armed:
            self._teller.say(f"armed, the motors at {np.round(np.array(self.gate.motor), 6).tolist()} m")
        try:
            self.device.command(executed + self._layout.zero.motor)
        except OSError as error:
            self._teller.say(f"the device cannot be commanded: {error}")
            return
        self._commands.tell(now + self._dead, command.stamp)

    def _watch(self, at: int, now: int) -> None:
        """Hold when commands end; a new controller is then expected, with a new count of its samples."""
        self._owners = self.count_publishers(self._commands.topic)
        self._teller.say_of_device(getattr(self.device, "words", str)())
        silence = self.gate.silent(now)
        if silence is not None:
            self._teller.say(f"no command has been executed for {silence:.3f} s: disarmed, the motors hold")
            self._tell_device("hold")
        if self._commands.received != self._seen:
            self._seen, self._quiet = self._commands.received, now
        elif self._seen and now - self._quiet > to_ns(self.limits.command_age or 1.0):
            self._commands.clear()
            self._seen, self._teller.last = 0, ""

    def _tell_device(self, what: str) -> None:
        getattr(self.device, what, lambda: None)()

    def _report(self) -> None:
        now = time.monotonic_ns()
        if now < self._next_report:
            return
        self._next_report = now + NS
        values = {f"commands refused by {name}": count for name, count in self.gate.refused.items()}
        facts = {
            "armed": self.gate.armed,
            "ticks without a reading": self._unread,
            "samples between two readings": self._grid.between,
            "samples missing": self._grid.missing,
        }
        loop = self._diagnostics.loop(facts, self._agenda.clocks, self.ports.inputs)
        level = ERROR if any(self.gate.refused.values()) else OK
        gate = self._diagnostics.status("gate", level, self._teller.last or "waits for commands", values)
        self._diagnostics.publish(self._wall_ns(), loop, gate)


class _Waiting:
    """Samples that wait in a port, whichever inbox it has."""

    def __init__(self, port: Input) -> None:
        self._port = port

    def next_due(self) -> int | None:
        return self._port.inbox.next_due()

    def next_stamp(self) -> int | None:
        return self._port.inbox.next_stamp()
