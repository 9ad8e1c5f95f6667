"""One run from the first process to the last.

    start -> configure -> everybody connected -> agree on the begin -> activate -> wait -> deactivate -> end

An abort ends the waiting: the controller brings the motors to where they stay, then all is ended. However a
run ends, what comes after ``wait`` is done: the recorder closes its bag, and no process is left.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial

from rthm_bringup.interruption import held_back
from rthm_bringup.run import roles
from rthm_bringup.run.beginning import begin_together
from rthm_bringup.run.company import look_at, refuse_company
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.ending import Ending
from rthm_bringup.run.environment import has_wheels, without_parents_ros
from rthm_bringup.run.external import begin_with_driver, wait_for_external, wait_for_heartbeat
from rthm_bringup.run.guards import Guards
from rthm_bringup.run.keys import Keys
from rthm_bringup.run.leaving import Leaving, Parts
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.processes import JOINT, Process, Processes
from rthm_bringup.run.rehearsal import Rehearsal
from rthm_bringup.run.stopped import AbortedError, StoppedError, UnconnectedError
from rthm_bringup.run.view import View
from rthm_bringup.run.watch import Watch
from rthm_core.clock import NS
from rthm_core.limits import require_limits
from rthm_core.ros.leader import NODE as LEADER
from rthm_core.topics import COMMAND, link_topic
from rthm_core.topics import LOOP as LOOP_TOPICS

COMPILING = 300.0
"""How long it may take to compile everything for the first time on a busy host, s."""
GRACE = NS // 5
"""After the last sample, for what is said about its use, ns."""
STANDSTILL = 10.0
"""How long nodes that are behind at the end may make no progress, s."""


class Session:
    """A run in progress.

    Parameters
    ----------
    plan
        What is to be done.
    view
        Where it is shown.
    """

    def __init__(self, plan: Plan, view: View) -> None:
        self._plan, self._view = plan, view
        self._processes = Processes()
        self._managed: list[str] = []
        self.ending = Ending()
        self._keys = Keys()
        self._watch = Watch(plan, self._processes, self.ending, self._keys)

    def run(self) -> Ending:
        """Do all of it."""
        network = self._plan.network
        with held_back() as interruption, self._keys, self._processes:
            look = self._watch.look
            with Conductor(look, network.domain, network.namespace, interruption.obey) as conductor:
                self._perform(conductor)
        return self.ending

    def _perform(self, conductor: Conductor) -> None:
        """Begin, wait and end, with nodes that can be asked."""
        try:
            self._connect(conductor)
            self._begin(conductor)
            self._wait(conductor)
        except StoppedError as stopped:
            self.ending.reason = self._explained(stopped)
            self._watch.abort("node", self.ending.reason)
        except AbortedError:
            self._view.phase("the test was aborted")
        except KeyboardInterrupt:
            self.ending.interrupted = True
        self._watch.end()
        self.ending.abort = conductor.abort
        with suppress(KeyboardInterrupt):
            leaving = Leaving(self._plan, conductor, self._parts(), self.ending)
            leaving.come_to_rest()
            self._view.phase("ending the test")
            leaving.end()
        self.ending.diagnostics = conductor.diagnostics

    def _parts(self) -> Parts:
        return Parts(self._managed, self._processes, self._watch.silent)

    def _connect(self, conductor: Conductor) -> None:
        """Start and configure all parts, and wait until they are connected."""
        self._look_around(conductor)
        self._view.phase("starting the nodes")
        own = [role for role in roles.PROGRAMS if role not in self._plan.external]
        own += roles.COORDINATOR if self._plan.virtual else []
        shared = roles.COMPOSED if self._plan.compose else ()
        for role in own:
            if role not in shared:
                self._start(role)
        if shared:
            self._start(*shared)
        rehearsal = Rehearsal(self._plan.spec, self._plan.duration if self._plan.hardware else None)
        conductor.wait_for(own, 60.0)
        self._managed = own + wait_for_external(conductor, self._plan, self._view)
        self._refuse_company(conductor, [*roles.PROGRAMS, *own])
        if self._has_driver():
            require_limits(self._plan.spec)
        conductor.set({"actuator": self._manner()})
        if self._plan.dry_run and "recorder" in self._managed:
            conductor.set({"recorder": {"silent": [COMMAND]}})
        self._view.phase("configuring the nodes")
        conductor.step("configure", self._managed, COMPILING)
        conductor.wait_until(
            lambda: rehearsal.over, COMPILING, lambda: "The analysis node did not become ready in time."
        )
        self._wait_ready(conductor)
        self._compare(conductor, rehearsal)
        self._guards = Guards(self._plan, conductor, self._managed, self.ending)
        self._guards.begin(self._view)

    def _compare(self, conductor: Conductor, rehearsal: Rehearsal) -> None:
        """Say what is predicted of a test with a real machine, which is refused where it is beyond limits."""
        self._view.phase("predicting the test")
        conductor.wait_until(
            lambda: rehearsal.predicted, COMPILING, lambda: "The prediction of the test took too long."
        )
        prediction = self.ending.prediction = rehearsal.prediction
        if prediction is not None:
            self._view.note(prediction.words)
            if prediction.refusal and not self._plan.dry_run:
                raise StoppedError(prediction.refusal)

    def _look_around(self, conductor: Conductor) -> None:
        """Refuse to begin where another test is, before anything is started."""
        end = time.monotonic() + look_at(self._plan.network)
        while time.monotonic() < end:
            conductor.sleep_until(time.time_ns() + NS // 10)
            self._refuse_company(conductor, self._plan.external)

    def _refuse_company(self, conductor: Conductor, own: Iterable[str]) -> None:
        alone = {*roles.PROGRAMS, *roles.COORDINATOR, LEADER}
        refuse_company(conductor.nodes(), self._plan.network, alone, {*own, LEADER})

    def _wait_ready(self, conductor: Conductor) -> None:
        """Wait for all connections; a driver need not listen to commands, nor tell when it uses one."""
        if not self._has_driver():
            conductor.wait_ready(self._managed, 30.0)
            return
        if "recorder" in self._managed:
            awaited = [topic for topic in LOOP_TOPICS if topic != link_topic("tau4")]
            conductor.set({"recorder": {"awaited": awaited}})
        with suppress(UnconnectedError):
            conductor.wait_ready(self._managed, 5.0)

    def _has_driver(self) -> bool:
        return "plant" not in self._managed

    def _is_hardware(self) -> bool:
        return self._plan.hardware or self._has_driver()

    def _manner(self) -> dict[str, bool | float]:
        """How the controller treats the plant."""
        plan = self._plan
        return {
            "hardware": self._is_hardware(),
            "dry_run": plan.dry_run,
            "heartbeat": plan.heartbeat,
            "excitation": plan.excitation,
        }

    def _start(self, *names: str) -> None:
        """Start the process of one node, or of several of the loop."""
        plan, name = self._plan, JOINT.join(names)
        told = roles.parameters(names[0], plan.spec_file, plan.bag, plan.virtual, plan.priority)
        role = names[0] if len(names) == 1 else names
        command = roles.command(role, plan.spec_file, told, plan.network.namespace)
        process = Process(name, command, plan.log / f"{name}.log")
        environment = without_parents_ros(os.environ, has_wheels())
        self._processes.start(
            process, environment | plan.network.variables() | {"ROS_LOG_DIR": str(plan.log)}
        )

    def _begin(self, conductor: Conductor) -> None:
        """Let the clocks of all nodes start together."""
        if self._plan.heartbeat:
            wait_for_heartbeat(conductor, self._plan, self._view)
        self.ending.begin = self._begin_virtual(conductor) if self._plan.virtual else self._agree(conductor)
        self.ending.realtime = tuple(
            name for name in roles.LOOP for p in self._processes.living() if name in p.nodes and p.realtime()
        )
        self._watch.begin(conductor, self._guards, self._managed, self._is_hardware())

    def _agree(self, conductor: Conductor) -> int:
        """Begin at an instant of the wall clock; a driver has chosen already at which instants it samples."""
        aligned = partial(begin_with_driver, conductor, self._plan) if self._has_driver() else int
        return begin_together(conductor, self._managed, self._plan.duration, aligned, self._view.note)

    def _begin_virtual(self, conductor: Conductor) -> int:
        """Begin at zero, the coordinator last, as it lets time pass."""
        duration = self._plan.duration
        conductor.set({name: {"start_time": 0, "duration": duration} for name in self._managed})
        conductor.step("activate", [name for name in self._managed if name != "coordinator"])
        conductor.step("activate", ["coordinator"])
        return 0

    def _wait(self, conductor: Conductor) -> None:
        """Let the test happen."""
        self._view.phase("the test runs" + (", a: abort" if self._keys.watched else ""))
        began, begin = time.monotonic(), self.ending.begin or 0
        if self._plan.virtual:
            self._watch_time(lambda: conductor.simulated_time, conductor)
        else:
            self._watch_time(lambda: (time.time_ns() - begin) / NS, conductor)
        self.ending.wall = time.monotonic() - began
        self._watch.end()
        self._wait_complete(conductor)

    def _wait_complete(self, conductor: Conductor) -> None:
        """Wait for the last samples; a host that is too busy may be behind."""
        if "recorder" not in self._managed:
            return
        before, deadline = "", time.monotonic() + STANDSTILL
        while True:
            complete, behind = conductor.trigger("recorder", "complete", 10.0)
            if complete:
                break
            if behind != before:
                before, deadline = behind, time.monotonic() + STANDSTILL
            if time.monotonic() > deadline:
                raise StoppedError(f"The recording is not complete: {behind}.")
            conductor.sleep_until(time.time_ns() + NS // 20)
        conductor.sleep_until(time.time_ns() + GRACE)

    def _watch_time(self, now: Callable[[], float], conductor: Conductor) -> None:
        """Wait until the time of the test, in s, is its duration; without end if there is none."""
        duration = self._plan.duration

        def over() -> bool:
            self._view.progress(max(0.0, now()), duration)
            return bool(duration) and now() >= duration

        conductor.wait_until(over, float("inf"), str)

    def _explained(self, stopped: StoppedError) -> str:
        """Sentence with what the node at fault said last, if it is ours."""
        words = [p.last_words() for p in self._processes.living() if stopped.node in p.nodes]
        return ": ".join([str(stopped), *(word for word in words if word)])
