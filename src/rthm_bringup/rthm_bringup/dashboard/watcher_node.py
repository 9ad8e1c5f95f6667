"""The ear of the dashboard: it hears a test, asks its nodes what they know, and can ask for an abort.

It listens with best effort, so that no publisher waits for it or sends anything twice, and takes what has
come ten times a second, all at once.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from struct import Struct
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import GetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState, TimeReference
from std_msgs.msg import String
from std_srvs.srv import Trigger

from rthm_analysis.dashboard import TOPICS, Facts, RunningTest
from rthm_bringup.run.environment import Network
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.ros import reach
from rthm_core.ros.leader import NODE as LEADER
from rthm_core.ros.polling import Mailbox, Onlooker
from rthm_core.ros.qos import latched, samples
from rthm_core.spec import read_spec
from rthm_core.topics import DIAGNOSTICS, EVENTS, JOINT_STATE, PLANT_STATE, SPEC

ASKED = {
    "recorder": ["bag", "start_time", "duration", "virtual"],
    "actuator": ["hardware", "dry_run"],
}
"""Parameters that are asked for, by node."""
BETWEEN_QUESTIONS = 1.0
"""Time between two questions, and between two looks at the graph, s."""
SILENT = 5.0
"""After how long without samples a test without a leader is over, s."""

_STAMP = Struct("<iI")
_DEPTH = 5000  # some seconds, as this process may have to wait for others


class Watcher:
    """Hears the test of a network.

    Parameters
    ----------
    network
        Where it is.

    Attributes
    ----------
    test
        The test; None: no spec has come yet.
    bag
        Where its recorder writes; empty: not known.
    over
        Whether it has ended.
    unread
        Why its spec cannot be used; empty: it can. Effects of somebody's own are declared by ``--effects``.
    """

    def __init__(self, network: Network) -> None:
        self._context = rclpy.Context()
        rclpy.init(
            context=self._context, domain_id=network.domain, signal_handler_options=SignalHandlerOptions.NO
        )
        self._node = Onlooker(
            "dashboard",
            namespace=network.namespace,
            context=self._context,
            enable_rosout=False,
            start_parameter_services=False,
        )
        reach.enforce(network.domain)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._spec, self._said, self._status = (
            self._mailbox(String, SPEC, latched()),
            self._mailbox(String, EVENTS, samples(100)),
            self._mailbox(DiagnosticArray, DIAGNOSTICS, samples(100)),
        )
        self._samples = {
            topic: self._mailbox(
                JointState if kind == JOINT_STATE else TimeReference, topic, samples(_DEPTH, reliable=False)
            )
            for topic, kind in TOPICS.items()
        }
        self._abort = self._node.create_client(Trigger, "actuator/abort")
        self._questions = {
            name: _Question(self._node.create_client(GetParameters, f"{name}/get_parameters"), names)
            for name, names in ASKED.items()
        }
        self.test: RunningTest | None = None
        self.bag, self.over, self.unread = "", False, ""
        self._first: int | None = None
        self._heard = self._looked = time.monotonic()
        self._led = False

    def close(self) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def abort(self) -> None:
        """Ask the controller to abort the test."""
        self._abort.call_async(Trigger.Request())

    @property
    def can_abort(self) -> bool:
        """Whether there is a controller that can be asked."""
        return bool(self._abort.service_is_ready()) and not self.over

    def take(self) -> None:
        """Take what has come; called ten times a second."""
        self._executor.spin_once(timeout_sec=0.0)
        for message, _ in self._spec.take():
            self._begin(deserialize_message(message, String).data)
        for topic, box in self._samples.items():
            for message, _ in box.take():
                self._hear(topic, message)
        for message, _ in self._said.take():
            if self.test:
                self.test.told.note_event(deserialize_message(message, String).data)
        for message, _ in self._status.take():
            self._note(deserialize_message(message, DiagnosticArray))
        if time.monotonic() > self._looked + BETWEEN_QUESTIONS:
            self._looked = time.monotonic()
            self._look_around()

    def _mailbox(self, kind: Any, topic: str, qos: QoSProfile) -> Mailbox:
        return Mailbox(self._node, kind, topic, qos)

    def _begin(self, text: str) -> None:
        try:
            self.test = RunningTest(read_spec(text))
            self.unread = ""
        except InputError as error:
            self.test, self.unread = None, f"The spec of the test that runs cannot be read: {error}"

    def _hear(self, topic: str, message: bytes) -> None:
        if self.test is None or self.over:
            return
        if topic == PLANT_STATE:
            self._heard = time.monotonic()
            self._first = self._first or _stamp(message)
        self.test.take(topic, message)

    def _note(self, message: DiagnosticArray) -> None:
        if self.test is None:
            return
        for status in message.status:
            self.test.told.note_status(status.name, {pair.key: pair.value for pair in status.values})

    def _look_around(self) -> None:
        led = any(
            name == LEADER and where == self._node.get_namespace()
            for name, where in self._node.get_node_names_and_namespaces()
        )
        silent = self._first is not None and time.monotonic() > self._heard + SILENT
        self.over = self.over or (self._led and not led) or (not self._led and silent)
        self._led = self._led or led
        if self.test and not self.over:
            self._ask(self.test)

    def _ask(self, test: RunningTest) -> None:
        """Ask the nodes, until the test has begun, and learn from what they answered."""
        for question in self._questions.values():
            if test.begun:
                break
            question.ask()
        recorder, actuator = (self._questions[name].answers for name in ASKED)
        self.bag = recorder.get("bag", "") or self.bag
        begin = recorder.get("start_time") or (0 if recorder.get("virtual") else None)
        whole = begin is not None
        if not whole and not self._led:  # started by somebody else, some time ago
            begin = self._first
        told = (bool(actuator.get(name)) for name in ASKED["actuator"])
        test.learn(Facts(begin, whole, float(recorder.get("duration") or 0.0), *told))


class _Question:
    """Parameters of a node, asked for again and again."""

    def __init__(self, client: Any, names: Iterable[str]) -> None:
        self._client, self._names = client, list(names)
        self.answers: dict[str, Any] = {}

    def ask(self) -> None:
        if self._client.service_is_ready():
            self._client.call_async(GetParameters.Request(names=self._names)).add_done_callback(self._take)

    def _take(self, answered: Any) -> None:
        result = answered.result()
        if result is not None and len(result.values) == len(self._names):
            values = map(parameter_value_to_python, result.values)
            self.answers = dict(zip(self._names, values, strict=True))


def _stamp(message: bytes) -> int:
    seconds, nanoseconds = _STAMP.unpack_from(message, 4)
    return int(seconds) * NS + int(nanoseconds)
