"""The loop in simulated time: events in granted windows, in lock step with all other parts.

A part that holds every message of a grant does its events before the bound, in the event order of the
contract, and answers. Nothing depends on when a message arrived, so that a run repeats to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable

from rclpy.executors import Executor
from rclpy.node import Node
from std_msgs.msg import Int64MultiArray

from rthm_core.ros.agenda import NEVER, Agenda, Position
from rthm_core.ros.grants import DONE, NOTHING, PARTS, SOURCES, Counts, Done, Grant, grant_to
from rthm_core.ros.ports import Ports
from rthm_core.ros.qos import samples


class Grants:
    """A part's side of the protocol: the newest grant, and the answer to it.

    Parameters
    ----------
    node
        Node of the part.
    part
        Its name in `PARTS`.
    heard
        Called after every grant.
    """

    def __init__(self, node: Node, part: str, heard: Callable[[], None] = lambda: None) -> None:
        self.newest: Grant | None = None
        self._part, self._heard = PARTS.index(part), heard
        self._done = node.create_publisher(Int64MultiArray, DONE, samples())
        self._grant = node.create_subscription(
            Int64MultiArray, grant_to(part), self._receive, samples(), raw=True
        )

    def answer(self, round_: int, upcoming: Position, sent: Counts) -> None:
        """Say that everything before the bound of this round is done."""
        self._done.publish(Done(self._part, round_, upcoming, sent).message())

    def matched(self) -> bool:
        """Whether a coordinator is there, on both topics."""
        return bool(self._done.get_subscription_count() and self._grant.get_publisher_count())

    def _receive(self, data: bytes) -> None:
        self.newest = Grant.read(data)
        self._heard()


class Observer:
    """Somebody who only listens, such as a recorder, and must not be left behind.

    Parameters
    ----------
    node
        Its node; to be called "recorder" by the protocol.
    """

    def __init__(self, node: Node) -> None:
        self._grants = Grants(node, "recorder", self._check)
        self._received = dict.fromkeys(SOURCES, 0)

    def greet(self) -> None:
        """Be part of the run from now on."""
        self._received = dict.fromkeys(SOURCES, 0)
        self._grants.answer(0, Position(NEVER, 0), NOTHING)

    def note(self, topic: str) -> None:
        """Count a message that was received on a topic (relative name)."""
        if topic in self._received:
            self._received[topic] += 1
            self._check()

    def _check(self) -> None:
        grant = self._grants.newest
        if grant and all(
            n >= exist for n, exist in zip(self._received.values(), grant.messages, strict=True)
        ):
            self._grants.newest = None
            self._grants.answer(grant.round, Position(NEVER, 0), NOTHING)


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
        """Wait for a message; work when a grant is complete.

        Returns
        -------
        bool
            Whether it was, and now is a good moment for work that can wait.
        """
        self._executor.spin_once(timeout_sec=0.2)
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
        counts = dict(zip(SOURCES, exist, strict=True))
        return all(port.received >= counts[port.topic] for port in self._ports.inputs)

    def _answer(self, round_: int) -> None:
        sent = {port.topic: port.sent for port in self._ports.outputs}
        counts = tuple(sent.get(topic, 0) for topic in SOURCES)
        self._grants.answer(round_, self._agenda.next(), counts)
