"""Node ``actuator``: the controller, watched by the safety monitor.

On every tick of Td3 it takes the newest state of the plant whose delay tau1 is over and publishes the
command u_d. A force reference whose delay tau3 is over changes u_d at once (``Td4 = 0``), which between
two ticks is told by an extra command, or at the next tick of Td4. Ticks that were missed are left out.

Beside a real machine it is armed first: until the measured state has been compared with the spec nothing is
sent, and the first command is where the motors stand.

To measure a rig it commands a small motion about there instead (`rthm_core.excitation`), through the same
limits, whatever plant and numerical side do.
"""

from __future__ import annotations

import sys
from functools import partial
from typing import ClassVar

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import ParameterDescriptor

from rthm_actuator.arming import differences
from rthm_actuator.outside import Ears, Outside
from rthm_actuator.overdue import Pulse
from rthm_actuator.safety import Expected, SafetyMonitor
from rthm_actuator.sensors import SENSORS
from rthm_actuator.shaping import Rig
from rthm_actuator.supervision import Broken
from rthm_actuator.watch import Watch
from rthm_core import events
from rthm_core.clock import NS, Rank, to_ns
from rthm_core.controller import Controller
from rthm_core.errors import InputError
from rthm_core.excitation import excitation
from rthm_core.limits import kept_limits
from rthm_core.link import Link
from rthm_core.owner import LIMIT as OWNER
from rthm_core.ros.agenda import Agenda
from rthm_core.ros.diagnostics import ERROR, OK
from rthm_core.ros.messages import JointSample
from rthm_core.ros.part import PartNode
from rthm_core.ros.process import run
from rthm_core.ros.realtime import RealTime
from rthm_core.slew import Floats
from rthm_core.spec import LimitsSpec, Spec
from rthm_core.substructure import interface
from rthm_core.topics import COMMAND, DRY_COMMAND, FORCE_REFERENCE, PLANT_STATE

PARAMETERS = {
    "hardware": (False, "whether the plant is a real machine: it is armed first, and no limit is off"),
    "dry_run": (False, "whether commands go to actuator/command_dry, and none is sent to the motors"),
    "heartbeat": (False, "whether an operator's heartbeat must be there from the start"),
    "excitation": (
        0.0,
        "size of a motion that measures the rig, in m; 0: the test is controlled",
    ),
}


class ActuatorNode(PartNode):
    """Publishes ``actuator/command``; sees the plant over tau1 and the force reference over tau3."""

    further: ClassVar[tuple[str, ...]] = tuple(PARAMETERS)

    def __init__(self) -> None:
        super().__init__("actuator")
        for name, (value, words) in PARAMETERS.items():
            self.declare_parameter(name, value, ParameterDescriptor(description=words))
        self._outside = Outside(self, Ears(self._judge, self._obey, self._beat))

    def connect(self, spec: Spec) -> None:
        """Open the topics of the controller."""
        loop = spec.loop()
        names = loop.actuator.names
        td1, td2 = loop.timing.ns("td1"), loop.timing.ns("td2")
        self._command = self.ports.output(COMMAND, names, fields=["position", "effort"], peers=1)
        if self.value("dry_run"):  # the topic of commands is there, and silent
            self._command = self.ports.output(DRY_COMMAND, names, fields=["position", "effort"])
        self._plant = self.ports.input(
            PLANT_STATE, (*loop.plant.dofs, *names), Link(spec, "tau1"), period=td1
        )
        self._plant.seen = self._see
        self._reference = self.ports.input(FORCE_REFERENCE, names, Link(spec, "tau3"), period=td2)
        for port in (self._plant, self._reference):
            port.unread = partial(self._unread, port.topic)

    def begin(self, spec: Spec, agenda: Agenda) -> None:
        """Put the controller to the steady state before the test, and the motors at rest."""
        timing = spec.loop().timing
        self._td3, td4 = timing.ns("td3"), timing.ns("td4")
        self._controller, self._test = Controller(spec), spec
        travel = self.value("excitation")
        self._excitation = excitation(spec, travel) if travel else None
        self._rest = self._controller.command(0)
        self._limits = kept_limits(spec, self.value("hardware"))
        self._watch = Watch(spec, self._limits, self.value("hardware"), not self.value("dry_run"))
        self._pulse = Pulse(to_ns(self._limits.heartbeat or 0.0), self.value("heartbeat"))
        self._safety = self._monitor(spec)
        if not self.value("hardware"):
            self._safety.arm(self._rest)
        self._told: set[str] = set()
        self._heard: events.Abort | None = None
        self._position = np.array(spec.plant.initial_position)[interface(spec).plant]
        self._state_used: int | None = None
        self._reference_used: int | None = None
        if td4:
            agenda.every("Td4", td4, Rank.CONTROL, self._hold_reference, skips=True)
        else:
            agenda.when_due(self._reference.inbox, self._reference_due, lambda stamp: Rank.NUMERICAL)
        agenda.every("Td3", self._td3, Rank.CONTROL, self._control, skips=True)

    def _monitor(self, spec: Spec) -> SafetyMonitor:
        timing = spec.loop().timing
        inputs = {
            self._plant.topic: Expected(self._plant.link.delay_ns, timing.ns("td1"), tuple(SENSORS)),
            self._reference.topic: Expected(self._reference.link.delay_ns, timing.ns("td2")),
        }
        rig = Rig(np.array(spec.k_tot), self._td3, lambda: self._watch.unloaded)
        return SafetyMonitor(self._limits, rig, inputs, to_ns(self.value("duration")))

    def _see(self, sample: JointSample) -> None:
        """Look at a state of the plant as it arrives."""
        if not self._safety.armed or sample.stamp < 0:
            self._watch.note(sample)
            return
        now = self.ports.now()
        self._safety.heard(self._plant.topic, sample.stamp, now)
        self._safety.judge(now, self._watch.see(sample, self._safety.last, now - sample.stamp))

    def _unread(self, topic: str, why: str) -> None:
        """Somebody sends what cannot be used."""
        self._safety.unread(topic, why)

    def _arm(self, at: int) -> None:
        """Compare the rig with the start of the spec; the first command is where the motors stand."""
        if self._safety.armed or self._safety.reason or not self._watch.values:
            return
        assert self._limits.start is not None
        away = differences(self._test, self._watch.values, self._limits.start)
        if away:
            self._safety.judge(at, Broken("start", away[0].value, away[0].allowed, away[0].words))
            return
        motors = self._watch.motors
        try:
            self._safety.arm(motors, at)
        except InputError as error:
            self._safety.judge(at, Broken("command", float(np.abs(motors).max()), None, str(error)))
            return
        self._rest, travel = motors, self.value("excitation")
        armed = events.write_event(events.ARMED, at=at / NS, motor=motors.tolist(), excitation=travel)
        self._tell(events.ARMED, armed)

    def _control(self, at: int, now: int) -> None:
        self._watch_owners()
        self._arm(at)
        z1 = self._plant.take(at)
        if z1 is not None:
            x1, v1 = self._watch.interface(z1)
            if self._safety.accept(self._plant.topic, z1.stamp, now, x1, v1):
                self._controller.latch_state(z1.stamp, x1, v1)
                self._position, self._state_used = x1, z1.stamp
        self._safety.judge(now, self._pulse.look(now))
        self._send(at, now)
        if self._state_used is not None:
            self._plant.tell(now, self._state_used)

    def _watch_owners(self) -> None:
        """End the test when an input has samples of a second publisher."""
        for port in (self._plant, self._reference):
            if port.ownership.words:
                words = f"{port.topic} has a second publisher: {port.ownership.words}"
                self._judge(Broken(OWNER, None, None, words))

    def _hold_reference(self, at: int, now: int) -> None:
        """Tick of Td4."""
        self._take_reference(at, now)
        self._use_reference(at, now)

    def _reference_due(self, at: int, now: int) -> None:
        """End of a delay, with ``Td4 = 0``; an overtaken reference is none."""
        if self._take_reference(at, now):
            self._use_reference(at, now)

    def _take_reference(self, at: int, now: int) -> bool:
        reference = self._reference.take(at)
        if reference is None:
            return False
        force = np.array(reference.effort)
        if not self._safety.accept(self._reference.topic, reference.stamp, now, force):
            return False
        self._controller.latch_force(reference.stamp, self._safety.reference(force))
        self._reference_used = reference.stamp
        return True

    def _use_reference(self, at: int, now: int) -> None:
        """Between two ticks of Td3, a reference is used in a command of its own, unless it is an old one."""
        if self._reference_used is None:
            return
        if at % self._td3 and at - self._reference_used - self._reference.link.reach_ns < self._td3:
            self._send(at, now)
        self._reference.tell(now, self._reference_used)

    def _send(self, at: int, now: int) -> None:
        u_d = self._safety.command(at, now, self._wanted(at), self._position)
        if u_d is not None:
            self._command.send(at, u_d, self._controller.force)
        if self._safety.abort is not None:
            self._tell_abort(now)

    def _wanted(self, at: int) -> Floats:
        """Command (m,) before all limits."""
        if self._excitation is None:
            return self._controller.command(at)
        return self._rest + self._excitation.at(at / NS)

    def _tell_abort(self, now: int) -> None:
        """Tell everybody, once, that the test is over, and once that the motors are where they stay."""
        abort = self._safety.abort
        assert abort is not None
        if events.ABORT not in self._told:
            self.get_logger().error(f"stopped at {abort.at:.6f} s: {abort.words}")
            if self._heard is None:  # else everybody has heard it as well
                self._tell(events.ABORT, events.write_abort(abort))
            self._told.add(events.ABORT)
        elif self._safety.at_rest and events.REST not in self._told:
            self._tell(events.REST, events.write_event(events.REST, at=now / NS))

    def _tell(self, kind: str, text: str) -> None:
        self._told.add(kind)
        self._outside.tell(text)

    def _judge(self, broken: Broken | None) -> None:
        self._safety.judge(self.ports.now(), broken)

    def _obey(self, abort: events.Abort) -> None:
        """Another node has aborted the test."""
        if self._safety.abort is None:
            self._heard = abort
            self._safety.obey(self.ports.now(), abort)

    def _beat(self, well: bool) -> None:
        self._pulse.beat(self.ports.now(), well)

    def rest(self) -> None:
        """Bring the motors back to rest when the test ends before its time."""
        ramp = self._limits.ramp
        if ramp and isinstance(self.loop, RealTime) and not self._safety.at_rest:
            self._safety.stop(self.loop.now(), "deactivated")
            self.loop.alone(2.0 * ramp, lambda: self._safety.at_rest)

    def statuses(self) -> list[DiagnosticStatus]:
        """State of the safety monitor."""
        limited = {f"commands limited by {name}": count for name, count in self._safety.limited.items()}
        return [self.diagnostics.status("safety monitor", *_state(self._safety, self._test), limited)]


def _state(safety: SafetyMonitor, test: Spec) -> tuple[bytes, str]:
    if safety.reason:
        return ERROR, f"stopped: {safety.reason}"
    return OK, "within limits" if test.limits not in (None, LimitsSpec()) else "no limits are set"


Node = ActuatorNode
"""Node of this module."""


def main() -> int:
    """Run the node until it is asked to end."""
    return run(ActuatorNode)


if __name__ == "__main__":
    sys.exit(main())
