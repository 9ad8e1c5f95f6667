"""The ear at a driver: it listens to ``plant/state`` for a while and sends no command unless asked to."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState

from rthm_bringup.driver.answer import check_swing, swing
from rthm_bringup.driver.heard import NO_NUMBER, Commanded, Heard, Publisher, Sample
from rthm_bringup.interruption import Interruption, held_back
from rthm_bringup.run.environment import Network
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.ros import reach
from rthm_core.ros.qos import samples
from rthm_core.spec import Spec
from rthm_core.topics import COMMAND, JOINT_STATE, PLANT_STATE

SETTLE = 0.5
"""How long discovery may take to tell all publishers once there is one, s."""

SAMPLES_WAITING = 5000
"""Samples that wait while this host is busy, so that what is lost was lost by the driver or on the way."""

NUMBERED = 2**63  # a middleware that does not number messages gives the largest integer


def listen(spec: Spec, network: Network, seconds: float, patience: float, distance: float = 0.0) -> Heard:
    """Listen for `seconds` from the first sample on; give up when none comes within `patience`, s.

    Parameters
    ----------
    network
        Where to listen.
    distance
        Swing of all motors that is commanded meanwhile, m; 0: no command is sent.

    Raises
    ------
    InputError
        If the swing would pass a limit of the spec, or somebody else commands the motors.
    """
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=network.domain, signal_handler_options=SignalHandlerOptions.NO)
    with held_back() as interruption:
        try:
            return _Ear(context, spec, network.namespace, interruption).hear(seconds, patience, distance)
        finally:
            rclpy.try_shutdown(context=context)


class _Ear:
    def __init__(
        self, context: rclpy.Context, spec: Spec, namespace: str, interruption: Interruption
    ) -> None:
        self._spec, self._loop, self._interruption = spec, spec.loop(), interruption
        self._node = rclpy.create_node("check_driver", namespace=namespace, context=context)
        reach.enforce(context.get_domain_id())
        self._executor = SingleThreadedExecutor(context=context)
        self._executor.add_node(self._node)
        self._heard: list[tuple[bytes, dict[str, Any]]] = []

    def hear(self, seconds: float, patience: float, distance: float) -> Heard:
        self._spin(patience, self._publishers)
        self._spin(SETTLE)
        publishers, commanded = self._publishers(), None
        if publishers and all(one.type_name == JOINT_STATE for one in publishers):
            reliable = all(one.reliable for one in publishers)
            self._subscribe(reliable)
            self._spin(patience, lambda: self._heard)
            gc.disable()
            if self._heard and distance:
                commanded = self._command(seconds, distance)
            elif self._heard:
                self._spin(seconds)
            gc.enable()
        listens = self._node.count_subscribers(self._node.resolve_topic_name(COMMAND)) > 0
        return Heard(publishers, tuple(_sample(*one) for one in self._heard), listens, commanded)

    def _publishers(self) -> tuple[Publisher, ...]:
        found = self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(PLANT_STATE))
        return tuple(
            Publisher(
                f"{one.node_namespace.rstrip('/')}/{one.node_name}",
                one.topic_type,
                one.qos_profile.reliability == ReliabilityPolicy.RELIABLE,
            )
            for one in found
        )

    def _subscribe(self, reliable: bool) -> None:
        def take(message: bytes, info: dict[str, Any]) -> None:
            self._heard.append((message, info))

        self._node.create_subscription(
            JointState, PLANT_STATE, take, samples(SAMPLES_WAITING, reliable), raw=True
        )

    def _spin(self, seconds: float, until: Callable[[], object] = lambda: False) -> None:
        deadline = time.monotonic() + seconds
        while not until() and time.monotonic() < deadline:
            self._interruption.obey()
            self._executor.spin_once(timeout_sec=0.02)

    def _command(self, seconds: float, distance: float) -> Commanded:
        """Send one swing, a command every Td3, and listen to the end of it."""
        m, names = len(self._loop.actuator.names), list(self._loop.actuator.names)
        last = _sample(*self._heard[-1]).position
        start = np.array(last[-m:] if len(last) > m else [np.nan] * m)
        check_swing(start, distance, seconds, self._spec)
        if self._node.count_publishers(self._node.resolve_topic_name(COMMAND)):
            raise InputError("Another node publishes actuator/command; end that test before a swing.")
        publisher = self._node.create_publisher(JointState, COMMAND, samples())
        self._spin(2.0, lambda: publisher.get_subscription_count() > 0)
        period, sent = self._loop.timing.ns("td3"), []
        begin = due = time.time_ns()
        message = JointState(name=names, effort=[0.0] * m)
        while due <= begin + seconds * NS:
            position = swing(start, distance, (due - begin) / NS / seconds)
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(due, NS)
            message.position = position.tolist()
            publisher.publish(message)
            sent.append((due, position))
            due += period
            self._spin((due - time.time_ns()) / NS)
        self._spin(SETTLE)
        return Commanded(np.array([stamp for stamp, _ in sent]), np.array([u for _, u in sent]))


def _sample(data: bytes, info: dict[str, Any]) -> Sample:
    message = deserialize_message(data, JointState)
    number = info.get("publication_sequence_number")
    stamp = int(message.header.stamp.sec) * NS + int(message.header.stamp.nanosec)
    return Sample(
        stamp,
        int(info["received_timestamp"]),
        NO_NUMBER if number is None or number >= NUMBERED else int(number),
        tuple(message.name),
        message.position.tolist(),
        message.velocity.tolist(),
        message.effort.tolist(),
    )
