"""How a test is left, however it ended: motors at rest, bag closed, nodes inactive."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterable
from contextlib import suppress
from typing import NamedTuple

from rthm_bringup.run import roles
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.ending import Ending
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.processes import Processes
from rthm_bringup.run.stopped import RefusedError, StoppedError
from rthm_core.clock import NS

MISSED = 7 * NS // 2
"""Time in which reliable delivery repeats what was missed, ns: the middleware asks every 3 s."""


class Parts(NamedTuple):
    """What a test consists of when it is left.

    Attributes
    ----------
    managed
        Nodes that the leader leads.
    processes
        Those of its own.
    silent
        Nodes for whose silence the test was ended.
    """

    managed: list[str]
    processes: Processes
    silent: set[str]


class Leaving:
    """Ends a test in good order.

    Parameters
    ----------
    plan, conductor, parts
        Of the run.
    ending
        Gets the death of a node as its reason.
    """

    def __init__(self, plan: Plan, conductor: Conductor, parts: Parts, ending: Ending) -> None:
        self._plan, self._conductor, self._parts, self._ending = plan, conductor, parts, ending
        limits = plan.spec.limits
        # A limited rate may take longer than the ramp.
        self._way_back = 2.0 * (limits.ramp or 0.0) if limits else 0.0

    def come_to_rest(self) -> None:
        """After an abort, wait until the controller has brought the motors to where they stay."""
        conductor = self._conductor
        conductor.watch = lambda: None
        if conductor.abort is None:
            return
        self._note_dead()
        if "actuator" in self._answering():
            with suppress(StoppedError):
                conductor.wait_until(lambda: conductor.rested, 1.0 + self._way_back, str)
        self._note_dead()

    def _note_dead(self) -> None:
        """Tell a process that died; what it left undone may have been seen before its death."""
        dead = [one.fate() for one in self._parts.processes.dead() if one.name not in roles.OBSERVERS]
        if dead:
            self._ending.reason = self._ending.reason or dead[0]

    def end(self) -> None:
        """Deactivate the loop first, the recorder last."""
        self._wake_silent()
        alive = self._answering()
        if "coordinator" in alive and set(alive) == set(self._parts.managed):
            self._let_time_stand()
        self._deactivate(name for name in alive if name == "coordinator")
        # The controller first: its motors come to rest while the plant still moves.
        self._deactivate(name for name in reversed(roles.LOOP) if name in alive)
        watching = self._deactivate(name for name in alive if name == "analysis")
        self._await_recorder()
        self._deactivate(name for name in alive if name == "recorder")
        if watching and self._ending.begin is not None:
            self._wait_for_analysis()
        with suppress(StoppedError):
            self._conductor.step("cleanup", [name for name in alive if name in self._plan.external], 5.0)

    def _let_time_stand(self) -> None:
        """End simulated time with all of it recorded: a sample that was lost has to be sent again."""
        deadline = time.monotonic() + MISSED / NS
        with suppress(StoppedError):
            while not self._conductor.trigger("coordinator", "stand", 5.0)[0] and time.monotonic() < deadline:
                self._conductor.sleep_until(time.time_ns() + NS // 20)

    def _wait_for_analysis(self) -> None:
        """Give the analysis node the time that it needs for the recording that was closed."""
        told = self._plan.bag.with_name("bag.energy.json")
        mine = not {"analysis", "recorder"} & self._plan.external
        if mine and self._plan.bag.joinpath("metadata.yaml").exists():
            with suppress(StoppedError):
                self._conductor.wait_until(told.exists, 60.0, str)

    def _wake_silent(self) -> None:
        """Let a recorder that was stopped close its bag; what moves motors stays as it is, and is killed."""
        for process in self._parts.processes.living():
            if process.nodes & self._parts.silent:
                process.send(signal.SIGCONT if process.name == "recorder" else signal.SIGKILL)

    def _await_recorder(self) -> None:
        """Give a recorder that was stopped the time to receive what it has missed, the abort among it."""
        if self._conductor.abort is not None and "recorder" in self._parts.silent:
            with suppress(StoppedError):
                self._conductor.sleep_until(time.time_ns() + MISSED)

    def _answering(self) -> list[str]:
        processes = self._parts.processes
        gone = {name for process in processes.dead() for name in process.nodes}
        gone |= self._parts.silent - {"recorder"}
        return [name for name in self._parts.managed if name not in gone]

    def _deactivate(self, names: Iterable[str]) -> list[str]:
        """Deactivate nodes, one after the other; return those that were."""
        done = []
        for name in names:
            try:
                self._conductor.step("deactivate", [name], 5.0 + self._way_back)
                done.append(name)
            except RefusedError:
                continue
            except StoppedError:
                self._ending.note(f"{name} did not answer when the test was ended (log: {self._plan.log}).")
        return done
