"""What reaches the controller from outside of the loop: events, aborts, an operator's heartbeat."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger

from rthm_actuator.supervision import Broken
from rthm_core import events
from rthm_core.ros.part import PartNode
from rthm_core.topics import EVENTS


class Ears(NamedTuple):
    """What is called when something is heard while a test is going on.

    Attributes
    ----------
    broken
        Somebody asks for an abort.
    abort
        Another node has aborted the test.
    beat
        The operator's heartbeat: whether all is well.
    """

    broken: Callable[[Broken], None]
    abort: Callable[[events.Abort], None]
    beat: Callable[[bool], None]


class Outside:
    """Topics and service of a controller for everybody else.

    Parameters
    ----------
    node
        The controller's node.
    ears
        What it does with what it hears.
    """

    def __init__(self, node: PartNode, ears: Ears) -> None:
        self._node, self._ears = node, ears
        self._events = node.create_publisher(String, EVENTS, 100)
        node.create_subscription(String, EVENTS, self._hear_event, 100)
        node.create_subscription(Bool, "abort", self._hear_abort, 10)
        node.create_subscription(Bool, "heartbeat", self._hear_beat, 10)
        node.create_service(Trigger, "~/abort", self._serve_abort)

    def tell(self, text: str) -> None:
        """Tell everybody an event."""
        if self._node.ports.speaking:
            self._events.publish(String(data=text))

    def _hear_event(self, message: String) -> None:
        abort = events.abort_of(events.read_event(message.data))
        if abort is not None and self._node.active:
            self._ears.abort(abort)

    def _hear_abort(self, message: Bool) -> None:
        if message.data:
            self._ask("the topic abort")

    def _hear_beat(self, message: Bool) -> None:
        if self._node.active:
            self._ears.beat(message.data)

    def _serve_abort(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._ask("the service actuator/abort")
        response.success = self._node.active
        response.message = "the motors go where on_abort says" if response.success else "no test is going on"
        return response

    def _ask(self, by: str) -> None:
        if self._node.active:
            self._ears.broken(Broken("operator", None, None, f"asked for by {by}"))
