"""Bags for the tests: any samples, in any storage, whole or cut off."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
NAN = float("nan")

Message = tuple[str, int, str, bytes]
"""Topic, time of reception (ns), type, bytes."""


def time(ns: int) -> object:
    """builtin_interfaces/Time of an instant."""
    return STORE.types["builtin_interfaces/msg/Time"](sec=int(ns // 10**9), nanosec=int(ns % 10**9))


def header(ns: int, frame: str = "") -> object:
    """std_msgs/Header with a stamp."""
    return STORE.types["std_msgs/msg/Header"](stamp=time(ns), frame_id=frame)


def joint_state(
    topic: str,
    stamp_ns: int,
    names: Sequence[str],
    position: Iterable[float] = (),
    velocity: Iterable[float] = (),
    effort: Iterable[float] = (),
    *,
    received_ns: int | None = None,
    frame: str = "",
    little: bool = True,
) -> Message:
    """A message of sensor_msgs/JointState."""
    kind = "sensor_msgs/msg/JointState"
    fields = (np.array(list(values), dtype=np.float64) for values in (position, velocity, effort))
    message = STORE.types[kind](header(stamp_ns, frame), list(names), *fields)
    payload = bytes(STORE.serialize_cdr(message, kind, little_endian=little))
    return topic, stamp_ns if received_ns is None else received_ns, kind, payload


def time_reference(topic: str, use_ns: int, sample_ns: int, source: str) -> Message:
    """A message of sensor_msgs/TimeReference."""
    kind = "sensor_msgs/msg/TimeReference"
    message = STORE.types[kind](header(use_ns), time(sample_ns), source)
    return topic, use_ns, kind, bytes(STORE.serialize_cdr(message, kind))


def text(topic: str, words: str, at_ns: int = 0) -> Message:
    """A message of std_msgs/String."""
    kind = "std_msgs/msg/String"
    return topic, at_ns, kind, bytes(STORE.serialize_cdr(STORE.types[kind](words), kind))


def rosbag2(
    folder: Path, messages: Iterable[Message], storage: str = "mcap", compression: str = "none"
) -> Path:
    """A bag as another rosbag2 tool writes it."""
    plugin = {"mcap": StoragePlugin.MCAP, "sqlite3": StoragePlugin.SQLITE3}[storage]
    writer = Writer(folder, version=9, storage_plugin=plugin)
    if compression != "none":
        writer.set_compression(CompressionMode[compression.upper()], CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, object] = {}
        for topic, received_ns, kind, payload in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], received_ns, payload)
    return folder


def mcap_file(
    path: Path, messages: Iterable[Message], chunk_size: int = 4096, compression: str = "ZSTD"
) -> Path:
    """One MCAP file in small chunks, without metadata.yaml."""
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size=chunk_size, compression=CompressionType[compression])
        writer.start(profile="ros2")
        channels: dict[str, int] = {}
        for number, (topic, received_ns, kind, payload) in enumerate(messages):
            if topic not in channels:
                schema = writer.register_schema(kind, "ros2msg", b"")
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            writer.add_message(channels[topic], received_ns, payload, received_ns, number)
        writer.finish()
    return path


START = 1_700_000_000_000_000_000
PERIOD = 1_200_000


def plant_samples(count: int = 200, topic: str = "/rthm/plant/state") -> list[Message]:
    """Samples of a plant with one dof and one actuator: x1 = cos, v1 = -sin, w1 unknown, u = 2 cos, F = k."""
    messages = []
    for k in range(count):
        t = k * PERIOD * 1e-9
        position, velocity, effort = (np.cos(t), 2.0 * np.cos(t)), (-np.sin(t), NAN), (NAN, float(k))
        messages.append(joint_state(topic, START + k * PERIOD, ("x1", "a1"), position, velocity, effort))
    return messages


@pytest.fixture
def plant_bag(tmp_path: Path) -> Callable[[str], Path]:
    """Write `plant_samples` in a storage."""
    return lambda storage: rosbag2(tmp_path / f"bag-{storage}", plant_samples(), storage)
