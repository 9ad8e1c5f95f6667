"""The two sides of a comparison of clocks, on the topics ``clocks/ask`` and ``clocks/answer``.

The times are those at which the middleware sent and received the messages, so that it does not matter how
long a node was busy before it looked at them. An answer has the node's name, when the question was sent and
received, and by how much the clock that stamps the node's samples leads that of the middleware, all in ns.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from rthm_core.clocks import Exchange
from rthm_core.ros.cdr import Walk
from rthm_core.ros.polling import Info, Listener, PollingNode

ASK, ANSWER = "clocks/ask", "clocks/answer"
QUICK = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
"""A message that has to be sent again is of no use."""


class Clock:
    """A node's side: answers when it is asked.

    Parameters
    ----------
    node
        Whose clock it is.
    lead
        Lead of the clock that stamps its samples over the middleware's, ns.
    """

    def __init__(self, node: PollingNode, lead: Callable[[], int]) -> None:
        self._name, self._lead = node.get_name(), lead
        self._answers = node.create_publisher(String, ANSWER, QUICK)
        self._asked = Listener(node, String, ASK, QUICK, self._answer)

    def _answer(self, question: bytes, info: Info) -> None:
        walk = Walk(question)
        if self._name in walk.string().split():
            times = info["source_timestamp"], info["received_timestamp"], self._lead()
            self._answers.publish(String(data=f"{self._name} {' '.join(map(str, times))}"))


class Asker:
    """The leader's side.

    Parameters
    ----------
    node
        The leader's.
    take
        Given the name of a node and an exchange with it.
    """

    def __init__(self, node: Node, take: Callable[[str, Exchange], None]) -> None:
        self._take = take
        self._questions = node.create_publisher(String, ASK, QUICK)
        node.create_subscription(String, ANSWER, self._hear, QUICK)

    def ask(self, names: Iterable[str]) -> None:
        """Ask nodes for their clocks."""
        self._questions.publish(String(data=" ".join(names)))

    def _hear(self, answer: String, info: dict[str, Any]) -> None:
        name, *times = answer.data.split()
        asked, received, lead = map(int, times)
        answered, heard = info["source_timestamp"] + lead, info["received_timestamp"]
        self._take(name, Exchange(asked, received + lead, answered, heard))
