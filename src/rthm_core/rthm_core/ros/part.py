"""Base of the nodes of the loop: topics, readiness, and one loop in real or simulated time.

What a transition does: ``configure`` opens the topics and rehearses, ``activate`` begins the loop,
``deactivate`` brings the part to rest, ``cleanup`` closes the topics.
"""

from __future__ import annotations

import time
from abc import abstractmethod

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.lifecycle import TransitionCallbackReturn
from std_srvs.srv import Trigger

from rthm_core.clock import NS, to_ns
from rthm_core.ros import system
from rthm_core.ros.agenda import NEVER, Agenda, Position
from rthm_core.ros.alive import Alive
from rthm_core.ros.diagnostics import Diagnostics
from rthm_core.ros.granted import Grants
from rthm_core.ros.managed import ManagedNode
from rthm_core.ros.ports import Ports
from rthm_core.ros.qos import samples
from rthm_core.ros.realtime import RealTime
from rthm_core.ros.virtual import Virtual
from rthm_core.spec import Spec

REHEARSED = 5
"""Events that are done before the test, unpublished, so that nothing in it is done for the first time."""


class PartNode(ManagedNode):
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
    ports, agenda, loop
        Its topics, what it has to do, and the loop that does it while a test is going on.
    """

    def __init__(self, part: str, leads: bool = False, yields: int = 0) -> None:
        super().__init__(part)
        self._part, self._leads, self._yields = part, leads, yields
        self.ports = Ports(self, samples())
        self.agenda = Agenda()
        self.loop: RealTime | Virtual | None = None
        self.diagnostics = Diagnostics(self)
        self._grants: Grants | None = None
        self._granted = system.Granted(0, False)
        self._next_report = 0
        self._given_up = False
        self._alive = Alive(self)
        self.create_service(Trigger, "~/ready", self._ready)

    @abstractmethod
    def connect(self, spec: Spec) -> None:
        """Open inputs and outputs on `self.ports`; InputError if the spec is not for this part."""

    @abstractmethod
    def begin(self, spec: Spec, agenda: Agenda) -> None:
        """Set the part to the start of a test and note down in the agenda what it does."""

    def rest(self) -> None:
        """Come to rest in an orderly way, when a test ends."""

    def statuses(self) -> list[DiagnosticStatus]:
        """What the part says of itself on /diagnostics, beside its loop."""
        return []

    def turn(self) -> bool:
        """Do what is next; called again and again while the process runs.

        Returns
        -------
        bool
            Whether now is a good moment for work that can wait.
        """
        if self.loop is not None:
            return self.loop.turn()
        self.executor.spin_once(timeout_sec=0.1)
        return True

    def next(self) -> Position:
        """Place of what is next, ns of the wall clock; later than anything while there is no test."""
        start = self.ports.start if self.loop is not None else None
        at, rank = self.agenda.next() if start is not None else Position(NEVER, 0)
        return Position(at + (start or 0), rank)

    def attend(self) -> None:
        """Do what can wait: begin by itself, say that it lives, and how it is."""
        if self.loop is None:
            self._autostart()
        self._alive.beat()
        self._report()

    def wall_ns(self) -> int:
        """Nanoseconds since 1970, by the clock that stamps the samples of a test."""
        return self.loop.wall_ns() if isinstance(self.loop, RealTime) else super().wall_ns()

    def configure(self, spec: Spec) -> None:
        """Open all topics and rehearse."""
        virtual = self.value("virtual")
        self.ports = Ports(self, samples(self.value("depth"), self.value("reliable")), polled=virtual)
        self.connect(spec)
        if virtual:
            self._lock_step()
        self._rehearse(spec)
        self._granted = self._prepared(virtual)

    def activate(self, spec: Spec) -> None:
        """Begin a test at `start_time`."""
        start, virtual = self.value("start_time"), self.value("virtual")
        self.agenda = Agenda(until=to_ns(self.value("duration")))
        self.ports.clear()
        self.begin(spec, self.agenda)
        system.hold_garbage()
        self.ports.start = start if start or virtual else self._chosen_start()
        self.ports.listening = self.ports.speaking = True
        self.loop = self._virtual() if virtual else self._real_time()
        self.ports.now = self.loop.now
        self.diagnostics.clear()
        self._next_report = 0

    def deactivate(self) -> None:
        """End the test."""
        self.rest()
        self.loop = None
        self.ports.listening = self.ports.speaking = False
        self._next_report = 0
        system.release_garbage()

    def release(self) -> None:
        """Leave all topics."""
        self.ports.close()

    def _prepared(self, virtual: bool) -> system.Granted:
        if virtual:
            return system.prepare_virtual()
        return system.prepare(max(self.value("priority") - self._yields, 0), self.value("lock_memory"))

    def _rehearse(self, spec: Spec) -> None:
        agenda = Agenda()
        self.begin(spec, agenda)
        for port in self.ports.inputs:
            port.rehearse()
        for _ in range(REHEARSED):
            agenda.run(agenda.next().at)
        self.ports.clear()

    def _real_time(self) -> RealTime:
        return RealTime(self.executor, self.agenda, self.ports, to_ns(self.value("spin_margin")))

    def _virtual(self) -> Virtual:
        return Virtual(self.executor, self.agenda, self.ports, self._lock_step())

    def _lock_step(self) -> Grants:
        if self._grants is None:
            self._grants = Grants(self, self._part)
        return self._grants

    def _chosen_start(self) -> int | None:
        """Full second, far enough ahead for those who get ready together with this node."""
        return (self.wall_ns() // NS + 2) * NS if self._leads else None

    def _autostart(self) -> None:
        """Configure once, then activate as soon as everybody is there."""
        if self._given_up or not self.value("autostart"):
            return
        if self.spec is None:
            self._given_up = self.trigger_configure() != TransitionCallbackReturn.SUCCESS
        elif not self._awaited():
            self._given_up = True
            self.trigger_activate()

    def _awaited(self) -> list[str]:
        """Topics whose other side is not there yet."""
        lone = self._grants is not None and not self._grants.matched()
        return self.ports.waiting() + (["virtual"] if lone else [])

    def _ready(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        waiting = self._awaited()
        response.success = self.spec is not None and not waiting
        response.message = f"waits for the other side of {', '.join(waiting)}" if waiting else "ready"
        if self.spec is None:
            response.message = "is not configured"
        return response

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
        stamp = (self.ports.start or 0) + now if virtual else self.wall_ns()
        self.diagnostics.publish(stamp, loop, *(self.statuses() if self.loop else []))
