"""What a node says of itself twenty times a second, so that nobody waits long for one that is gone."""

from __future__ import annotations

import time

from rclpy.node import Node
from std_msgs.msg import String

from rthm_core.clock import NS

TOPIC = "alive"
"""Relative name of the topic; its content is the name of the node."""
PERIOD = NS // 20


class Alive:
    """Publishes that a node is alive.

    Parameters
    ----------
    node
        The node; whoever drives it calls `beat` as often as it can.
    """

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(String, TOPIC, 10)
        self._message = String(data=node.get_name())
        self._next = 0

    def beat(self) -> None:
        """Say so, if it is time."""
        now = time.monotonic_ns()
        if now >= self._next:
            self._next = now + PERIOD
            self._publisher.publish(self._message)
