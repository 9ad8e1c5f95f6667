"""Who publishes the topics of a test, and by which clocks: looked at before it begins, and while it runs."""

from __future__ import annotations

import time
from functools import partial

from rthm_actuator.supervision import Broken
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.ending import Ending
from rthm_bringup.run.limits import OwnerWatch
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.stopped import StoppedError
from rthm_bringup.run.view import View
from rthm_core.clock import NS
from rthm_core.clocks import limit_of
from rthm_core.ros import system
from rthm_core.topics import LOOP

COMPARING = 2.0
"""How long the clocks of hosts are compared before a test, s."""
LEADER_PRIORITY = 5
"""Real-time priority of a leader that watches a machine, or compares clocks: below the loop, and drivers."""


class Guards:
    """Watches over the owners of topics and the clocks of hosts.

    Parameters
    ----------
    plan
        Of the run.
    conductor
        Looks at the graph, and asks for clocks.
    managed
        Nodes of the test that can be asked.
    ending
        Gets the offsets of all clocks.
    """

    def __init__(self, plan: Plan, conductor: Conductor, managed: list[str], ending: Ending) -> None:
        self._plan, self._conductor, self._ending = plan, conductor, ending
        self._elsewhere = [name for name in managed if name in plan.external and name != "recorder"]
        self._clocks = conductor.clock_watch(self._elsewhere, limit_of(plan.spec))
        self._owners = OwnerWatch(partial(conductor.rivals, LOOP))
        machine = plan.hardware or "plant" not in managed
        self._urgent = plan.priority != 0 and (machine or bool(self._elsewhere))

    def begin(self, view: View) -> None:
        """Look before anything moves.

        Raises
        ------
        StoppedError
            When a limit is broken already.
        """
        if self._urgent:  # a busy host must not keep it from what it watches
            system.prepare(LEADER_PRIORITY, lock_memory=False)
        if self._elsewhere:
            view.phase("comparing clocks")
        deadline = time.monotonic() + COMPARING * bool(self._elsewhere)
        while time.monotonic() < deadline:
            self._clocks.look()
            self._conductor.sleep_until(time.time_ns() + NS // 50)
        broken = self.look()
        if broken is not None:
            raise StoppedError(f"The test did not begin: {broken.words}.")

    def look(self) -> Broken | None:
        """Return what is broken now, if anything is."""
        self._clocks.look()
        external = self._plan.external - {"recorder"}
        self._ending.clocks = dict.fromkeys(sorted(external)) | self._clocks.offsets
        return self._owners.broken() or (None if self._plan.any_clock else self._clocks.broken())
