"""Node ``actuator``: the controller, watched by the safety monitor.

On every tick of Td3 it takes the newest state of the plant whose delay tau1 is over and publishes the
command u_d. A force reference whose delay tau3 is over changes u_d at once (``Td4 = 0``), which between
two ticks is told by an extra command, or at the next tick of Td4.
"""

from __future__ import annotations

import sys

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus

from rthm_actuator.safety import Expected, SafetyMonitor
from rthm_core.clock import NS, Rank, to_ns
from rthm_core.controller import Controller
from rthm_core.link import Link
from rthm_core.ros.agenda import Agenda
from rthm_core.ros.diagnostics import ERROR, OK
from rthm_core.ros.part import PartNode
from rthm_core.ros.process import run
from rthm_core.ros.realtime import RealTime
from rthm_core.spec import LimitsSpec, Spec
from rthm_core.substructure import interface


class ActuatorNode(PartNode):
    """Publishes ``actuator/command``; sees the plant over tau1 and the force reference over tau3."""

    def __init__(self) -> None:
        super().__init__("actuator")

    def connect(self, spec: Spec) -> None:
        """Open the topics of the controller."""
        loop = spec.loop()
        names = loop.actuator.names
        td1, td2 = loop.timing.ns("td1"), loop.timing.ns("td2")
        self._command = self.ports.output("actuator/command", names, fields=["position", "effort"], peers=1)
        self._plant = self.ports.input(
            "plant/state", loop.interface.plant_dof, Link(spec, "tau1"), period=td1
        )
        self._reference = self.ports.input("numerical/force_reference", names, Link(spec, "tau3"), period=td2)

    def begin(self, spec: Spec, agenda: Agenda) -> None:
        """Put the controller to the initial state that it has seen for ever, and the motors at rest."""
        timing = spec.loop().timing
        self._td3, td4 = timing.ns("td3"), timing.ns("td4")
        self._controller = Controller(spec)
        self._safety = self._monitor(spec)
        self._told = False
        self._position = np.array(spec.plant.initial_position)[interface(spec).plant]
        self._state_used: int | None = None
        self._reference_used: int | None = None
        if td4:
            agenda.every("Td4", td4, Rank.CONTROL, self._hold_reference)
        else:
            agenda.when_due(self._reference.inbox, self._reference_due, lambda stamp: Rank.NUMERICAL)
        agenda.every("Td3", self._td3, Rank.CONTROL, self._control)

    def _monitor(self, spec: Spec) -> SafetyMonitor:
        timing = spec.loop().timing
        inputs = {
            self._plant.topic: Expected(self._plant.link.delay_ns, timing.ns("td1")),
            self._reference.topic: Expected(self._reference.link.delay_ns, timing.ns("td2")),
        }
        rest, end = self._controller.command(0), to_ns(self.value("duration"))
        return SafetyMonitor(spec.limits, rest, np.array(spec.k_tot), inputs, end)

    def _control(self, at: int, now: int) -> None:
        self._watch_owners(at)
        z1 = self._plant.take(at)
        if z1 is not None and self._safety.accept(self._plant.topic, at, z1.position, z1.velocity):
            self._controller.latch_state(z1.stamp, z1.position, z1.velocity)
            self._position = np.array(z1.position)
            self._state_used = z1.stamp
        self._send(at)
        if self._state_used is not None:
            self._plant.tell(now, self._state_used)

    def _watch_owners(self, at: int) -> None:
        """Stop when an input has samples of a second publisher (limit ``owner``)."""
        for port in (self._plant, self._reference):
            if port.ownership.words:
                self._safety.trip(at, f"{port.topic} has a second publisher: {port.ownership.words}")

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
        if reference is None or not self._safety.accept(self._reference.topic, at, reference.effort):
            return False
        self._controller.latch_force(reference.stamp, self._safety.reference(reference.effort))
        self._reference_used = reference.stamp
        return True

    def _use_reference(self, at: int, now: int) -> None:
        """Between two ticks of Td3, a reference is used in a command of its own."""
        if at % self._td3:
            self._send(at)
        if self._reference_used is not None:
            self._reference.tell(now, self._reference_used)

    def _send(self, at: int) -> None:
        u_d = self._safety.command(at, self._controller.command(at), self._position)
        self._command.send(at, u_d, self._controller.force)
        if self._safety.reason and not self._told:
            self._told = True
            self.get_logger().error(f"stopped at {at / NS:.6f} s: {self._safety.reason}")

    def rest(self) -> None:
        """Bring the motors back to rest when the test ends before its time."""
        ramp = self._safety.limits.ramp
        if ramp and isinstance(self.loop, RealTime) and not self._safety.at_rest:
            self._told = True
            self._safety.stop(self.loop.now(), "deactivated")
            self.loop.alone(2.0 * ramp, lambda: self._safety.at_rest)

    def statuses(self) -> list[DiagnosticStatus]:
        """State of the safety monitor."""
        limited = {f"commands limited by {name}": count for name, count in self._safety.limited.items()}
        return [self.diagnostics.status("safety monitor", *_state(self._safety), limited)]


def _state(safety: SafetyMonitor) -> tuple[bytes, str]:
    if safety.reason:
        return ERROR, f"stopped: {safety.reason}"
    return OK, "within limits" if safety.limits != LimitsSpec() else "no limits are set"


def main() -> int:
    """Run the node until it is asked to end."""
    return run(ActuatorNode)


if __name__ == "__main__":
    sys.exit(main())
