"""How a test is left, however it ended: motors at rest, bag closed, nodes inactive."""

from __future__ import annotations

import signal
from collections.abc import Iterable
from contextlib import suppress
from typing import NamedTuple

from rthm_bringup.run import roles
from rthm_bringup.run.conductor_node import Conductor, StoppedError
from rthm_bringup.run.ending import Ending
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.processes import Processes


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
        dead = [one.fate() for one in self._parts.processes.dead() if one.name not in roles.OBSERVERS]
        if dead:
            self._ending.reason = self._ending.reason or dead[0]
        if "actuator" in self._answering():
            with suppress(StoppedError):
                conductor.wait_until(lambda: conductor.rested, 1.0 + self._way_back, str)

    def end(self) -> None:
        """Deactivate the loop first, the recorder last."""
        self._wake_silent()
        alive = self._answering()
        self._deactivate(name for name in alive if name == "coordinator")
        # The controller first: its motors come to rest while the plant still moves.
        self._deactivate(name for name in reversed(roles.LOOP) if name in alive)
        watching = self._deactivate(name for name in alive if name == "analysis")
        self._deactivate(name for name in alive if name == "recorder")
        if watching and self._ending.begin is not None:
            self._wait_for_analysis()
        with suppress(StoppedError):
            self._conductor.step("cleanup", [name for name in alive if name in self._plan.external], 5.0)

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
            if process.name in self._parts.silent:
                process.send(signal.SIGCONT if process.name == "recorder" else signal.SIGKILL)

    def _answering(self) -> list[str]:
        gone = {process.name for process in self._parts.processes.dead()}
        gone |= self._parts.silent - {"recorder"}
        return [name for name in self._parts.managed if name not in gone]

    def _deactivate(self, names: Iterable[str]) -> list[str]:
        """Deactivate nodes, one after the other; return those that were."""
        done = []
        for name in names:
            with suppress(StoppedError):
                self._conductor.step("deactivate", [name], 5.0 + self._way_back)
                done.append(name)
        return done
