"""Base of the nodes of the loop: lifecycle, parameters, readiness, and one loop in time.

unconfigured --configure--> inactive --activate--> active --deactivate--> inactive --cleanup--> unconfigured
spec, ports,             the loop            at rest                   ports
rehearsal                 begins                                       closed
"""

from __future__ import annotations

import time
from abc import abstractmethod
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import SetParametersResult
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from rthm_core.clock import NS, to_ns
from rthm_core.errors import InputError
from rthm_core.ros import system
from rthm_core.ros.agenda import Agenda
from rthm_core.ros.diagnostics import Diagnostics
from rthm_core.ros.parameters import OWN, declare_own, declare_spec, spec_of
from rthm_core.ros.ports import Ports
from rthm_core.ros.qos import samples
from rthm_core.ros.realtime import RealTime
from rthm_core.ros.virtual import Grants, Virtual
from rthm_core.spec import Spec

REHEARSED = 5
"""Events that are done before the test, unpublished, so that nothing in it is done for the first time."""


class LoopNode(LifecycleNode):  # type: ignore[misc]
    """A part of the loop as a node.

    Parameters
    ----------
    part
        Name of the node, and of the part in a run in simulated time.
    leads
        Whether this node chooses the start of the test when `start_time` does not.
    yields
        By how much less real-time priority it asks for, as others have less time to spare at one instant.

    Attributes
    ----------
    spec, ports, agenda, loop
        What the node is configured with, and what it is doing.
    """

    def __init__(self, part: str, leads: bool = False, yields: int = 0) -> None:
        super().__init__(part, namespace="/rthm", allow_undeclared_parameters=True)
        self._part, self._leads, self._yields = part, leads, yields
        self._besides = {*self._parameters, *OWN}
        declare_own(self)
        declare_spec(self, self._besides)
        self.spec: Spec | None = None
        self.ports = Ports(self, samples())
        self.agenda = Agenda()
        self.loop: RealTime | Virtual | None = None
        self._grants: Grants | None = None
        self._granted = system.Granted(0, False)
        self.diagnostics = Diagnostics(self)
        self._next_report = 0
        self._given_up = False
        self.add_on_set_parameters_callback(self._check_change)
        self.create_service(Trigger, "~/ready", self._ready)

    @abstractmethod
    def connect(self, spec: Spec) -> None:
        """Open inputs and outputs on `self.ports`; InputError if the spec is not for this part."""

    @abstractmethod
    def begin(self, spec: Spec, agenda: Agenda) -> None:
        """Set the part to the start of a test and note down in the agenda what it does."""

    def rest(self) -> None:
        """Come to rest in an orderly way, when a test ends early."""

    def statuses(self) -> list[DiagnosticStatus]:
        """What the part says of itself on /diagnostics, beside its loop."""
        return []

    def value(self, name: str) -> Any:
        """Value of one of the node's own parameters."""
        return self.get_parameter(name).value

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the spec, open all topics and rehearse."""
        try:
            self._configure(spec_of(self, self._besides))
        except InputError as error:
            self._close()
            return self._refuse(str(error))
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Begin a test at `start_time`."""
        start, virtual = self.value("start_time"), self.value("virtual")
        if start and not virtual and start < time.time_ns():
            ago = (time.time_ns() - start) / NS
            return self._refuse(
                f"start_time is {start}, {ago:.3f} s ago, but must lie ahead; set a later one."
            )
        self.agenda = Agenda(until=to_ns(self.value("duration")))
        self.ports.clear()
        assert self.spec is not None
        self.begin(self.spec, self.agenda)
        self._start(start, virtual)
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End the test."""
        self._stop()
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Leave all topics; a new spec can then be set."""
        self._close()
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End whatever goes on."""
        self._stop()
        self._close()
        return super().on_shutdown(state)

    def turn(self) -> None:
        """Do what is next; called again and again while the process runs."""
        if self.loop is None:
            self.executor.spin_once(timeout_sec=0.1)
            self._autostart()
        elif not self.loop.turn():
            return
        self._report()

    def close(self) -> None:
        """Come to rest; the process ends."""
        self._stop()

    def _configure(self, spec: Spec) -> None:
        self.ports = Ports(self, samples(self.value("depth"), self.value("reliable")))
        self.connect(spec)
        if self.value("virtual"):
            self._lock_step()
        self._rehearse(spec)
        priority = max(self.value("priority") - self._yields, 0)
        self._granted = system.prepare(priority, self.value("lock_memory"))
        self.spec = spec

    def _rehearse(self, spec: Spec) -> None:
        agenda = Agenda()
        self.begin(spec, agenda)
        for port in self.ports.inputs:
            port.rehearse()
        for _ in range(REHEARSED):
            agenda.run(agenda.next().at)
        self.ports.clear()

    def _start(self, start: int, virtual: bool) -> None:
        system.hold_garbage()
        self.ports.start = start if start or virtual else self._next_second()
        self.ports.speaking = self.ports.listening = True
        if virtual:
            self.loop = Virtual(self.executor, self.agenda, self.ports, self._lock_step())
        else:
            self.loop = RealTime(self.executor, self.agenda, self.ports, to_ns(self.value("spin_margin")))
        self.ports.now = self.loop.now
        self.diagnostics.clear()
        self._next_report = 0

    def _next_second(self) -> int | None:
        return (time.time_ns() // NS + 1) * NS if self._leads else None

    def _stop(self) -> None:
        if self.loop is None:
            return
        self.rest()
        self.loop = None
        self._next_report = 0
        self.ports.speaking = self.ports.listening = False
        system.release_garbage()

    def _close(self) -> None:
        self.ports.close()
        self.spec = None

    def _lock_step(self) -> Grants:
        if self._grants is None:
            self._grants = Grants(self, self._part)
        return self._grants

    def _autostart(self) -> None:
        """Configure once, then activate as soon as everybody is there."""
        if not self.value("autostart") or self._given_up:
            return
        if self.spec is None:
            self._given_up = self.trigger_configure() != TransitionCallbackReturn.SUCCESS
        elif not self._awaited():
            self._given_up = True
            self.trigger_activate()

    def _awaited(self) -> list[str]:
        waiting = self.ports.waiting()
        if self._grants is not None and not self._grants.matched():
            waiting.append("virtual")
        return waiting

    def _ready(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        waiting = self._awaited()
        response.success = self.spec is not None and not waiting
        if self.spec is None:
            response.message = "is not configured"
        else:
            response.message = f"waits for the other side of {', '.join(waiting)}" if waiting else "ready"
        return response

    def _check_change(self, changes: list[Parameter]) -> SetParametersResult:
        for change in changes:
            if self.loop is not None:
                return _refused(change, "before the node is activated")
            if self.spec is not None and change.name not in self._besides:
                return _refused(change, "before the node is configured")
        return SetParametersResult(successful=True)

    def _report(self) -> None:
        """Tell the state once a second, in simulated time once a simulated second."""
        virtual = isinstance(self.loop, Virtual)
        now = self.ports.now() if virtual else time.monotonic_ns()
        if now < self._next_report:
            return
        self._next_report = now // NS * NS + NS
        facts = {
            "state": self._state_machine.current_state[1],
            "real-time priority": self._granted.priority,
            "memory locked": self._granted.locked,
        }
        loop = self.diagnostics.loop(facts, self.agenda.clocks if self.loop else [], self.ports.inputs)
        stamp = (self.ports.start or 0) + now if virtual else time.time_ns()
        self.diagnostics.publish(stamp, loop, *(self.statuses() if self.loop else []))

    def _refuse(self, sentence: str) -> TransitionCallbackReturn:
        self.get_logger().error(sentence)
        return TransitionCallbackReturn.FAILURE


def _refused(change: Parameter, when: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=f"{change.name} can be changed only {when}")
