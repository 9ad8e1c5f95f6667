"""The loop in simulated time: events in granted windows, in lock step with all other parts.

A part that holds every message of a grant does its events before the bound, in the event order of the
contract, and answers. Nothing depends on when a message arrived, so that a run repeats to the last bit.
"""

from __future__ import annotations

from rclpy.executors import Executor

from rthm_core.ros.agenda import Agenda
from rthm_core.ros.granted import Grants
from rthm_core.ros.grants import SOURCES, Counts
from rthm_core.ros.ports import Ports

BETWEEN_LOOKS = 0.0001
"""Time after which a part looks again for samples that its grant speaks of, s."""


class Virtual:
    """Runs an agenda in granted windows.

    Parameters
    ----------
    executor, agenda
        As in real time.
    ports
        What the part has received and sent.
    grants
        The part's side of the protocol.
    """

    def __init__(self, executor: Executor, agenda: Agenda, ports: Ports, grants: Grants) -> None:
        self._executor, self._agenda, self._ports, self._grants = executor, agenda, ports, grants
        self._now = 0
        grants.newest = None
        self._answer(0)

    def now(self) -> int:
        """Instant of the event that was done last, ns after the start of the test."""
        return self._now

    def turn(self) -> bool:
        """Wait for a grant; work when all its samples are there.

        Returns
        -------
        bool
            Whether it was, and now is a good moment for work that can wait.
        """
        self._executor.spin_once(timeout_sec=BETWEEN_LOOKS if self._grants.newest else 0.2)
        grant = self._grants.newest
        if grant is None or not self._holds(grant.messages):
            return False
        while self._agenda.next() < grant.bound:
            self._now = self._agenda.next().at
            self._agenda.run(self._now)
        self._ports.flush()
        self._grants.newest = None
        self._answer(grant.round)
        return True

    def _holds(self, exist: Counts) -> bool:
        for port in self._ports.inputs:
            port.poll()
        counts = dict(zip(SOURCES, exist, strict=True))
        return all(port.received >= counts[port.topic] for port in self._ports.inputs)

    def _answer(self, round_: int) -> None:
        sent = {port.topic: port.sent for port in self._ports.outputs}
        counts = tuple(sent.get(topic, 0) for topic in SOURCES)
        self._grants.answer(round_, self._agenda.next(), counts)
