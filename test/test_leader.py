"""The leader hears everybody, however seldom it gets to listen."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String

from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.environment import Network
from rthm_core.ros import alive

pytestmark = [pytest.mark.usefixtures("environment")]
NAMES = ("actuator", "numerical", "recorder", "analysis", "plant")


@pytest.fixture
def context(network: Network, environment: dict[str, str]) -> Iterator[rclpy.Context]:
    context = rclpy.Context()
    options = SignalHandlerOptions.NO
    rclpy.init(context=context, domain_id=network.domain, signal_handler_options=options)
    yield context
    rclpy.try_shutdown(context=context)


def test_all_beats_that_have_come_are_heard_before_the_leader_judges(
    context: rclpy.Context, network: Network
) -> None:
    looks: list[set[str]] = []
    heard: set[str] = set()
    node = rclpy.create_node("somebody", namespace=network.namespace, context=context)
    publisher = node.create_publisher(String, alive.TOPIC, 100)
    with Conductor(lambda: looks.append(set(heard)), network.domain, network.namespace) as conductor:
        conductor.beaten = heard.add
        deadline = time.monotonic() + 30
        while not publisher.get_subscription_count() and time.monotonic() < deadline:
            time.sleep(0.05)
        for name in NAMES:
            publisher.publish(String(data=name))
        time.sleep(1.0)  # it is busy
        conductor.wait_until(lambda: len(looks) >= 1, 10.0, str)
    node.destroy_node()
    assert looks[0] == set(NAMES)
