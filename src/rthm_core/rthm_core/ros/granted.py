"""A part's side of the protocol of lock step: the grant that it has, and its answer."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from std_msgs.msg import Int64MultiArray

from rthm_core.ros.agenda import NEVER, Position
from rthm_core.ros.grants import DONE, NOTHING, PARTS, SOURCES, Counts, Done, Grant, grant_to
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
