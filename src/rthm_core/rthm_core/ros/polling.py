"""Subscriptions that their owner empties when it wants to.

An executor that hands over every message by itself wakes its thread and builds a task for each, which costs
several times more than taking it. Who need not act on a message at once, such as a recorder or a part in
simulated time, takes all that are there in one go.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

Info = dict[str, int]
"""What the middleware tells of a message: ``received_timestamp`` and ``source_timestamp`` in ns, numbers."""


class Listener:
    """Messages of one topic, as bytes, handed over by the executor of the node.

    Parameters
    ----------
    node
        Who receives them.
    message_type, topic, qos
        As for a subscription.
    receive
        Called with every message and what the middleware tells of it.
    """

    def __init__(
        self,
        node: PollingNode | Onlooker,
        message_type: Any,
        topic: str,
        qos: QoSProfile,
        receive: Callable[[bytes, Info], None],
    ) -> None:
        def take(*message: Any) -> None:
            """Take a message from an executor that hands over two arguments, or one pair of them."""
            receive(*(message[0] if len(message) == 1 else message))

        self.node = node
        self.subscription: Subscription = node.create_subscription(message_type, topic, take, qos, raw=True)
        self.subscription._callback_type = Subscription.CallbackType.WithMessageInfo

    def matched(self, least: int = 1) -> bool:
        """Whether all publishers that are known, and at least so many, are connected."""
        known = self.node.count_publishers(self.subscription.topic_name)
        return bool(self.publishers() >= max(least, known))

    def publishers(self) -> int:
        """Publishers that are connected."""
        return int(self.subscription.get_publisher_count())

    def close(self) -> None:
        """Leave the topic."""
        self.node.destroy_subscription(self.subscription)


class Mailbox(Listener):
    """Messages of one topic, as bytes, that wait until they are taken.

    Parameters
    ----------
    node, message_type, topic, qos
        As for a listener.
    """

    def __init__(self, node: PollingNode | Onlooker, message_type: Any, topic: str, qos: QoSProfile) -> None:
        super().__init__(node, message_type, topic, qos, lambda message, info: None)
        self._type = message_type
        node.unserved.add(self.subscription)

    def take(self) -> Iterator[tuple[bytes, Info]]:
        """Take what has arrived, oldest first."""
        handle = self.subscription.handle
        with handle:
            while (taken := handle.take_message(self._type, True)) is not None:
                yield taken

    def close(self) -> None:
        """Leave the topic."""
        self.node.unserved.discard(self.subscription)
        super().close()


class Polling:
    """Makes a node keep the subscriptions of its mailboxes from its executor.

    Attributes
    ----------
    unserved
        Subscriptions that no executor serves.
    """

    def __init__(self, name: str, **options: Any) -> None:
        self.unserved: set[Subscription] = set()
        super().__init__(name, **options)  # type: ignore[call-arg]

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Subscriptions that an executor serves."""
        return (one for one in super().subscriptions if one not in self.unserved)  # type: ignore[misc]


class PollingNode(Polling, LifecycleNode):  # type: ignore[misc]
    """Lifecycle node with mailboxes."""


class Onlooker(Polling, Node):  # type: ignore[misc]
    """Node with mailboxes that is no part of a test."""
