"""The hand of a run on its nodes: lifecycle transitions, parameters and readiness, over their services."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from types import TracebackType
from typing import Any, TypeVar

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs import msg as lifecycle
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import Trigger

from rthm_bringup.run.asking import Services, parameter
from rthm_bringup.run.limits import ClockWatch
from rthm_bringup.run.question import CHANGES
from rthm_bringup.run.stopped import RefusedError, StoppedError, UnconnectedError
from rthm_core import events
from rthm_core.clock import NS
from rthm_core.clocks import Offset
from rthm_core.ros import alive, leader, reach
from rthm_core.ros.comparing import Asker
from rthm_core.topics import CLOCKS, DIAGNOSTICS, EVENTS, NAMESPACE

NODE_ANSWERS_WITHIN = 20.0
"""How long a node on a busy host may take to answer, s."""

M = TypeVar("M")


def _past(deadline: float) -> bool:
    return time.monotonic() > deadline


class Conductor:
    """Client of the nodes of one test.

    Parameters
    ----------
    watch
        Called all the time while something is awaited; what it raises ends the waiting.
    domain, namespace
        Of the nodes.
    obey
        Called like `watch`, whatever is watched: raises KeyboardInterrupt if somebody asked for the end.

    Attributes
    ----------
    diagnostics : dict
        What each node told last on ``/diagnostics``, by the name of its status.
    simulated_time : float
        How far a run in simulated time has come, s.
    abort : Abort or None
        What was the first abort that anybody told.
    rested : bool
        Whether the controller has told that the motors are where they stay after an abort.
    beaten
        Called with the name of every node that says that it is alive.
    """

    def __init__(
        self,
        watch: Callable[[], None],
        domain: int,
        namespace: str = NAMESPACE,
        obey: Callable[[], None] = lambda: None,
    ) -> None:
        self.watch, self._obey = watch, obey
        self._namespace, self._word = namespace, leader.new_word()
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        self._node = rclpy.create_node(leader.NODE, namespace=namespace, context=self._context)
        reach.enforce(domain)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._services = Services(self._node, namespace, self.wait_until)
        self._clocks = self._node.create_publisher(JointState, CLOCKS, 10)
        self.diagnostics: dict[str, dict[str, str]] = {}
        self.simulated_time = 0.0
        self.abort: events.Abort | None = None
        self.rested = False
        self.beaten: Callable[[str], None] = lambda name: None
        self._events = self._node.create_publisher(String, EVENTS, 100)
        self._node.create_subscription(String, EVENTS, self._note_event, 100)
        self._alive = self._node.create_subscription(
            String, alive.TOPIC, lambda message: self.beaten(message.data), 100
        )
        self._node.create_subscription(DiagnosticArray, DIAGNOSTICS, self._note, 100)
        self._node.create_subscription(Float64, "virtual/time", self._note_time, 10)

    def __enter__(self) -> Conductor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def wait_until(
        self, condition: Callable[[], bool], seconds: float, why: Callable[[], str], every: float = 0.02
    ) -> None:
        """Wait for `condition`, looking again after every message, and after `every` s if none comes.

        Raises
        ------
        StoppedError
            With the sentence of `why` when it is not met after `seconds`.
        """
        deadline = time.monotonic() + seconds
        while not condition():
            self._obey()
            self._hear_beats()
            self.watch()
            if time.monotonic() > deadline:
                raise StoppedError(why())
            self._executor.spin_once(timeout_sec=every)

    def _hear_beats(self) -> None:
        """Take all beats that have come: one for each turn of the executor is too few on a busy host."""
        handle = self._alive.handle
        with handle:
            while (taken := handle.take_message(String, False)) is not None:
                self.beaten(taken[0].data)

    def sleep_until(self, wall: int) -> None:
        """Wait for an instant of the wall clock, ns."""
        remaining = (wall - time.time_ns()) / NS
        self.wait_until(
            lambda: time.time_ns() >= wall,
            remaining + 10.0,
            lambda: "The clock of this host does not advance.",
        )

    def nodes(self) -> list[tuple[str, str]]:
        """Names and namespaces of all nodes that are known, the leader's own included."""
        return list(self._node.get_node_names_and_namespaces())

    def clock_watch(self, names: Collection[str], limit: float) -> ClockWatch:
        """Make a watch over the clocks of nodes; it is served when the leader waits."""
        watch = ClockWatch(names, limit, lambda: asker.ask(names), self.tell_clocks)
        asker = Asker(self._node, watch.take)
        return watch

    def tell_clocks(self, offsets: Mapping[str, Offset]) -> None:
        """Publish offsets of clocks, for the recording: position is the offset, effort its uncertainty, s."""
        for name, one in offsets.items():
            message = JointState(name=[name], position=[one.offset], effort=[one.uncertainty])
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(one.at, NS)
            self._clocks.publish(message)

    def rivals(self, topics: Iterable[str]) -> dict[str, list[str]]:
        """Full names of the nodes that publish each of these topics which has more than one publisher."""
        found = {}
        for topic in topics:
            name = self._node.resolve_topic_name(topic)
            if self._node.count_publishers(name) > 1:
                ends = self._node.get_publishers_info_by_topic(name)
                found[topic] = [_full_name(end.node_namespace, end.node_name) for end in ends]
        return found

    def is_managed(self, name: str) -> bool:
        """Whether a node of this name offers lifecycle services now."""
        return bool(self._services.client(name, "change_state").service_is_ready())

    def wait_for(self, names: Iterable[str], seconds: float) -> None:
        """Wait until all of these nodes can be asked."""
        absent = list(names)

        def arrived() -> bool:
            absent[:] = [name for name in absent if not self.is_managed(name)]
            return not absent

        self.wait_until(
            arrived, seconds, lambda: f"{' and '.join(absent)} did not appear within {seconds:g} s."
        )

    def step(self, step: str, names: Iterable[str], seconds: float = NODE_ANSWERS_WITHIN) -> None:
        """Bring all of these nodes through a transition: configure, activate, deactivate, cleanup.

        From before it is activated until it is deactivated, a node answers to this leader alone.

        Raises
        ------
        RefusedError
            When one of them refuses, once all have answered.
        """
        names = list(names)
        if step in ("activate", "deactivate"):
            self._lock(names, step == "activate", seconds)
        request = ChangeState.Request(transition=lifecycle.Transition(id=CHANGES[step].number))
        for name, answer in self._services.ask(
            dict.fromkeys(names, request), "change_state", seconds, step
        ).items():
            if not answer.success:
                raise RefusedError(f"{name} refused to {step}", name)

    def _lock(self, names: list[str], closed: bool, seconds: float) -> None:
        """Lock nodes to this leader, or open them; a driver of somebody else's may have no lock."""
        value = leader.lock_of(self._word) if closed else self._word
        request = SetParameters.Request(parameters=[parameter(leader.PARAMETER, value)])
        self._services.ask(dict.fromkeys(names, request), "set_parameters", seconds)

    def states(self, names: Iterable[str]) -> dict[str, int]:
        """Lifecycle state of each of these nodes, a constant of `lifecycle_msgs.msg.State`."""
        answers = self._services.ask(
            dict.fromkeys(names, GetState.Request()), "get_state", NODE_ANSWERS_WITHIN
        )
        return {name: answer.current_state.id for name, answer in answers.items()}

    def publishers(self, topic: str) -> list[str]:
        """Names of the nodes in the namespace of the test that publish a topic."""
        ends = self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(topic))
        return [end.node_name for end in ends if end.node_namespace == self._namespace]

    def set(self, parameters: Mapping[str, Mapping[str, Any]], seconds: float = NODE_ANSWERS_WITHIN) -> None:
        """Set parameters, per node; a tuple is a list of numbers.

        Raises
        ------
        StoppedError
            When a node refuses, or does not answer.
        """
        requests = {
            name: SetParameters.Request(parameters=[parameter(*item) for item in values.items()])
            for name, values in parameters.items()
        }
        for name, answer in self._services.ask(requests, "set_parameters", seconds).items():
            for result in answer.results:
                if not result.successful:
                    raise StoppedError(f"{name} refused a parameter: {result.reason}")

    def trigger(self, name: str, service: str, seconds: float) -> tuple[bool, str]:
        """Call a service without arguments; return whether it worked, and what it said."""
        answer = self._services.ask({name: Trigger.Request()}, service, seconds)[name]
        return bool(answer.success), str(answer.message)

    def wait_ready(self, names: Iterable[str], seconds: float) -> None:
        """Wait until each of these nodes is connected to all that it needs.

        Raises
        ------
        UnconnectedError
            With what each of them waits for.
        """
        waiting = dict.fromkeys(names, "")
        deadline = time.monotonic() + seconds
        while waiting:
            answers = self._services.ask(
                dict.fromkeys(waiting, Trigger.Request()), "ready", NODE_ANSWERS_WITHIN
            )
            waiting = {name: answer.message for name, answer in answers.items() if not answer.success}
            if waiting and time.monotonic() > deadline:
                raise UnconnectedError("; ".join(f"{name} {message}" for name, message in waiting.items()))
            pause = time.monotonic() + 0.05
            self.wait_until(partial(_past, pause), 1.0, str)

    def samples(self, topic: str) -> AbstractContextManager[list[JointState]]:
        """List that fills with the samples of a topic as long as the ``with`` block lasts."""
        return self._heard(JointState, topic, 100)

    def beats(self, topic: str) -> AbstractContextManager[list[Bool]]:
        """List that fills with what an operator's heartbeat says as long as the ``with`` block lasts."""
        return self._heard(Bool, topic, 10)

    @contextmanager
    def _heard(self, message_type: type[M], topic: str, depth: int) -> Iterator[list[M]]:
        found: list[M] = []
        subscription = self._node.create_subscription(message_type, topic, found.append, depth)
        try:
            yield found
        finally:
            self._node.destroy_subscription(subscription)

    def tell(self, abort: events.Abort) -> None:
        """Abort the test: the controller obeys, the recorder writes it down."""
        self.abort = self.abort or abort
        self._events.publish(String(data=events.write_abort(abort)))

    def _note_event(self, message: String) -> None:
        event = events.read_event(message.data)
        self.abort = self.abort or events.abort_of(event)
        self.rested = self.rested or event.get("event") == events.REST

    def _note(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.diagnostics[status.name] = {pair.key: pair.value for pair in status.values}

    def _note_time(self, message: Float64) -> None:
        self.simulated_time = message.data


def _full_name(namespace: str, name: str) -> str:
    """Name of a node on the graph; its endpoints are known a moment before its name."""
    return "a node without a name" if name.startswith("_NODE_NAME") else f"{namespace.rstrip('/')}/{name}"
