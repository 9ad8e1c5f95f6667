"""The loop in real time: one thread, absolute deadlines on the monotonic clock.

    executor serves messages          spin          event        executor ...
    |---------------------------------|=============|############|--------
                                      deadline - margin          deadline

Waiting in the executor ends some 60 to 200 us late, so it ends `margin` early and the rest is spent watching
the clock. What arrives meanwhile waits in the middleware until the event is done.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable

from rclpy.executors import Executor

from rthm_core.clock import NS, to_ns
from rthm_core.ros import wall
from rthm_core.ros.agenda import Agenda
from rthm_core.ros.alive import PERIOD
from rthm_core.ros.ports import Ports

LONGEST_WAIT = PERIOD
"""Longest stay in the executor, ns; bounds how late a signal is noticed, and how long no beat is given."""


class WallClock:
    """Wall-clock time that never steps: the monotonic clock, shifted once to the wall clock."""

    def __init__(self) -> None:
        self._shift = min((_shift() for _ in range(20)), key=lambda pair: pair[0])[1]
        self._shown = wall.emulated(os.environ.get(wall.VARIABLE, ""))

    def now(self) -> int:
        """Nanoseconds since 1970."""
        return self._shown(time.monotonic_ns() + self._shift)


class RealTime:
    """Runs an agenda against the clock.

    Parameters
    ----------
    executor
        Serves the node's subscriptions and services while the next event is not due.
    agenda
        What is to be done when.
    ports
        Know the start of the test; nothing is due before it is known.
    margin
        How long before a deadline the executor is left, ns.
    """

    def __init__(self, executor: Executor, agenda: Agenda, ports: Ports, margin: int) -> None:
        self._executor, self._agenda, self._ports, self._margin = executor, agenda, ports, margin
        self._clock = WallClock()

    def now(self) -> int:
        """Time since the start of the test, ns; negative before it."""
        return self._clock.now() - (self._ports.start or 0)

    def wall_ns(self) -> int:
        """Nanoseconds since 1970, by the clock that stamps the samples."""
        return self._clock.now()

    def turn(self) -> bool:
        """Serve the executor until the next deadline comes near, or meet the deadline.

        Returns
        -------
        bool
            Whether now is a good moment for work that can wait.
        """
        if self._ports.start is None:
            self._executor.spin_once(timeout_sec=LONGEST_WAIT / NS)
            return True
        due = self._due()
        left = due - self.now()
        if left > self._margin:
            self._executor.spin_once(timeout_sec=min(left - self._margin, LONGEST_WAIT) / NS)
            return left > LONGEST_WAIT
        while self.now() < due:
            pass
        self._meet(due)
        self._catch_up()
        return True

    def alone(self, seconds: float, done: Callable[[], bool]) -> None:
        """Go on without the executor, and so without anything arriving, until `done`, at most `seconds`."""
        end = self.now() + to_ns(seconds)
        while not done() and self.now() < end:
            due = self._due()
            time.sleep(max(min(due, end) - self.now(), 0) / NS)
            if self.now() >= due:
                self._meet(due)

    def _due(self) -> int:
        """Instant of the next event that is worth doing."""
        self._agenda.skip(self.now())
        return self._agenda.next().at

    def _meet(self, due: int) -> None:
        """Do all events of this instant."""
        while self._agenda.next().at == due:
            began = self.now()
            _, entry = self._agenda.run(began)
            entry.judge(due, began, self.now())
        self._ports.flush()

    def _catch_up(self) -> None:
        """Far behind, let one message in before the next instant."""
        if self._agenda.next().at < self.now() - NS // 1000:
            self._executor.spin_once(timeout_sec=0)


def _shift() -> tuple[int, int]:
    """Time that two readings of the monotonic clock took, and the wall clock's lead over their middle, ns."""
    before, wall, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
    return after - before, wall - (before + after) // 2
