"""A bare rclpy loop: the messages of a test, at its clocks, and nothing else is done.

    python -m benchmarks.realtime.bare PART PERIOD BEGIN DURATION

``plant`` and ``rest`` publish at each tick what the plant, and the numerical substructure and the controller
together, publish; they receive what these receive, and drop it. ``observer`` takes everything, as a recorder
does. All of it is bytes that were prepared: no message is built and none is read. It runs as the nodes of a
test do: `EventsExecutor`, deadlines on the monotonic clock, real-time priority, no garbage collection.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from typing import NamedTuple

from rthm_bringup.run.domain import Claim
from rthm_bringup.run.environment import Network, has_wheels, without_parents_ros
from rthm_core.clock import NS

LOOP = {
    "plant/state": ("JointState", 2),
    "numerical/state": ("JointState", 1),
    "numerical/force_reference": ("JointState", 1),
    "actuator/command": ("JointState", 1),
    "links/tau1": ("TimeReference", 0),
    "links/tau2": ("TimeReference", 0),
    "links/tau3": ("TimeReference", 0),
    "links/tau4": ("TimeReference", 0),
}
"""Topics, the types of their messages, and how many names these have."""


class Part(NamedTuple):
    """What a process publishes and receives at each tick, and how many clocks it has."""

    publishes: tuple[str, ...]
    receives: tuple[str, ...]
    clocks: int


PARTS = {
    "plant": Part(("plant/state", "links/tau4"), ("actuator/command",), 1),
    "rest": Part(
        ("numerical/state", "numerical/force_reference", "actuator/command", "links/tau1", "links/tau2",
         "links/tau3"),
        ("plant/state", "plant/state", "numerical/force_reference"),
        2,
    ),
}  # fmt: skip
OBSERVERS = 2
"""Processes that take everything: a recorder and an analysis."""

HEAD_START = 6.0
"""Time in which all processes start and find each other, s."""

LEAVING = 60.0
"""Time in which a process that is done leaves the graph, s."""

CLOCKS = sum(part.clocks for part in PARTS.values())

PRIORITY = 50
"""Real-time priority that is asked for, as nodes of the loop do by default."""


def missed_ticks(period: float, duration: float) -> int:
    """Ticks of all clocks that ended only when the next one was due, in a bare loop of this length, s."""
    claim = Claim()
    environment = without_parents_ros(os.environ, has_wheels()) | Network(claim.domain).variables()
    begin = time.monotonic_ns() + round(HEAD_START * NS)
    told = [str(round(period * NS)), str(begin), str(duration)]
    names = [*PARTS, *["observer"] * OBSERVERS]
    started = [
        subprocess.Popen(
            [sys.executable, "-m", "benchmarks.realtime.bare", name, *told],
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        for name in names
    ]
    answers = [_answer(process, HEAD_START + duration + LEAVING) for process in started][: len(PARTS)]
    claim.release()
    if not all(answers):
        raise RuntimeError(f"a bare loop ended with status {[process.returncode for process in started]}")
    return sum(json.loads(answer)["missed"] for answer in answers)


def _answer(process: subprocess.Popen[str], patience: float) -> str:
    """What a process told; as it leaves, Fast DDS may wait for ever for a callback of its own."""
    try:
        return process.communicate(timeout=patience)[0]
    except subprocess.TimeoutExpired:
        process.kill()
        return process.communicate()[0]


def main(name: str, period: int, begin: int, duration: float) -> None:
    """Be one of the processes; `period` and `begin` in ns of the monotonic clock. Tell the missed ticks."""
    import rclpy
    from rclpy.experimental import EventsExecutor

    from rthm_core.ros import system

    rclpy.init()
    node = rclpy.create_node(f"bare_{name}_{os.getpid()}")
    end = begin + round(duration * NS)
    if name == "observer":
        _observe(node, end)
        return
    executor = EventsExecutor()
    executor.add_node(node)
    part = PARTS[name]
    publish = [(_publisher(node, topic), _bytes(topic)) for topic in part.publishes]
    for topic in part.receives:
        node.create_subscription(_type(topic), topic, lambda data: None, _qos(), raw=True)
    system.prepare(PRIORITY, True)
    system.hold_garbage()
    due, missed, margin = begin, 0, 100_000
    while due < end:
        if time.monotonic_ns() > end:  # a loop that has collapsed may be minutes behind
            missed += part.clocks * -((due - end) // period)
            break
        executor.spin_once(timeout_sec=0)  # far behind, one message is still let in
        while (left := due - time.monotonic_ns()) > margin:
            executor.spin_once(timeout_sec=(left - margin) / NS)
        while time.monotonic_ns() < due:
            pass
        for publisher, data in publish:
            publisher.publish(data)
        due += period
        missed += part.clocks * (time.monotonic_ns() > due)
    executor.shutdown()
    print(json.dumps({"missed": missed}), flush=True)


def _observe(node, end: int) -> None:  # type: ignore[no-untyped-def]
    """Take all messages, fifty times a second."""
    taken = [
        node.create_subscription(_type(topic), topic, lambda data: None, _qos(), raw=True) for topic in LOOP
    ]
    while time.monotonic_ns() < end:
        time.sleep(0.02)
        for subscription, topic in zip(taken, LOOP, strict=True):
            with subscription.handle:
                while subscription.handle.take_message(_type(topic), True) is not None:
                    pass


def _publisher(node, topic: str):  # type: ignore[no-untyped-def]
    return node.create_publisher(_type(topic), topic, _qos())


def _bytes(topic: str) -> bytes:
    from rthm_core.ros.messages import JointStateWriter, TimeReferenceWriter

    kind, size = LOOP[topic]
    if kind == "TimeReference":
        return TimeReferenceWriter(topic[-4:]).bytes(0, 0)
    return JointStateWriter([f"x{k}" for k in range(size)]).bytes(0, *[[0.0] * size] * 3)


def _type(topic: str):  # type: ignore[no-untyped-def]
    import sensor_msgs.msg

    return getattr(sensor_msgs.msg, LOOP[topic][0])


def _qos():  # type: ignore[no-untyped-def]
    from rthm_core.ros.qos import samples

    return samples()


if __name__ == "__main__":
    words = sys.argv[1:]
    main(words[0], int(words[1]), int(words[2]), float(words[3]))
