"""What the leader of a test looks at while it runs: processes, beats, owners, clocks, aborts, a key."""

from __future__ import annotations

import time
from collections.abc import Iterable

from rthm_bringup.run import roles
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.ending import Ending
from rthm_bringup.run.guards import Guards
from rthm_bringup.run.heartbeats import Heartbeats
from rthm_bringup.run.keys import ABORT, Keys
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.processes import Processes
from rthm_bringup.run.stopped import AbortedError, StoppedError
from rthm_core.clock import NS
from rthm_core.events import Abort
from rthm_core.limits import kept_limits


class Watch:
    """Ends a test when something in it is over; observers may go.

    Parameters
    ----------
    plan, processes, ending
        Of the run.
    keys
        Of its terminal.

    Attributes
    ----------
    silent
        Nodes that had fallen silent when the test was ended for it.
    """

    def __init__(self, plan: Plan, processes: Processes, ending: Ending, keys: Keys) -> None:
        self._plan, self._processes, self._ending, self._keys = plan, processes, ending, keys
        self._conductor: Conductor | None = None
        self._guards: Guards | None = None
        self._heartbeats: Heartbeats | None = None
        self._begun = False
        self.silent: set[str] = set()

    def begin(self, conductor: Conductor, guards: Guards, managed: Iterable[str], hardware: bool) -> None:
        """Watch a test that has begun."""
        self._conductor, self._guards, self._begun = conductor, guards, True
        limit = kept_limits(self._plan.spec, hardware).heartbeat
        if limit is not None and not self._plan.virtual:
            self._heartbeats = Heartbeats(set(managed) - roles.OBSERVERS, limit)
            conductor.beaten = self._heartbeats.beat

    def look(self) -> None:
        """Look at everything.

        Raises
        ------
        StoppedError
            When a process died that the test needs.
        AbortedError
            When the test was aborted, by whomever.
        """
        for process in self._processes.dead():
            if not self._begun or process.name not in roles.OBSERVERS:
                raise StoppedError(process.fate())
            self._ending.note(process.fate())
        if self._conductor is not None:
            self._judge(self._conductor)

    def end(self) -> None:
        """Abort nothing any more; only processes that die are told."""
        self._conductor = self._heartbeats = None

    def _judge(self, conductor: Conductor) -> None:
        if self._heartbeats is not None:
            self._judge_beats(self._heartbeats)
        if ABORT in self._keys.pressed().lower():
            self.abort("operator", f"the key {ABORT} was pressed")
        broken = self._guards.look() if self._guards else None
        if broken is not None:
            self.abort(broken.limit, broken.words, broken.value, broken.allowed)
        if conductor.abort is not None:
            raise AbortedError(conductor.abort)

    def _judge_beats(self, heartbeats: Heartbeats) -> None:
        silence = heartbeats.look(time.monotonic())
        if heartbeats.deaf:
            self._ending.note(
                f"The leader stalled for {heartbeats.deaf:.3f} s; nothing was supervised meanwhile."
            )
        if silence is not None:
            self.silent.add(silence.name)
            words = f"the node {silence.name} has been silent for {silence.seconds:.3f} s"
            self.abort("heartbeat", words, silence.seconds, heartbeats.limit)

    def abort(self, limit: str, words: str, value: float | None = None, allowed: float | None = None) -> None:
        """Abort the running test: tell everybody, and have it ended."""
        if self._conductor is not None:
            at = (time.time_ns() - (self._ending.begin or 0)) / NS
            at = self._conductor.simulated_time if self._plan.virtual else at
            self._conductor.tell(Abort(at, limit, value, allowed, words))
