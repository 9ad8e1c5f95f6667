"""The recording as rosbag2: every topic of the contract, MCAP, version 9, the spec first."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.concealed.loop import W1, Recording
from benchmarks.concealed.world import ns
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
_T = STORE.types
_TIME, _HEADER = _T["builtin_interfaces/msg/Time"], _T["std_msgs/msg/Header"]


def _split(stamps: np.ndarray) -> np.ndarray:
    """Seconds and nanoseconds as the eight bytes of a stamp, shape (n, 8)."""
    parts = np.stack([stamps // 10**9, stamps % 10**9], axis=1).astype("<u4")
    return parts.view(np.uint8).reshape(-1, 8)


def _stamp(ns_: int) -> Any:
    return _TIME(sec=ns_ // 10**9, nanosec=ns_ % 10**9)


def joint_states(stamps: np.ndarray, names: list[str], **columns: np.ndarray) -> list[bytes]:
    """Serialise one JointState per row; `columns` are position, velocity, effort: (n, names), as known.

    All messages of a topic have the same layout, so one is serialised and the others are filled in.
    """
    marks = {k: 10.0 ** -(300 + i) * np.arange(1.0, 1 + len(names)) for i, k in enumerate(columns)}
    empty = {k: np.zeros(0) for k in ("position", "velocity", "effort")}
    one = _T["sensor_msgs/msg/JointState"](
        header=_HEADER(stamp=_stamp(0), frame_id=""), name=names, **(empty | marks)
    )
    raw = bytes(STORE.serialize_cdr(one, one.__msgtype__))
    block = np.tile(np.frombuffer(raw, np.uint8), (len(stamps), 1))
    block[:, 4:12] = _split(stamps)
    for key, mark in marks.items():
        at = raw.index(mark.tobytes())
        values = np.ascontiguousarray(columns[key], dtype="<f8")
        block[:, at : at + 8 * len(names)] = values.view(np.uint8)
    return [row.tobytes() for row in block]


def time_references(used: np.ndarray, stamps: np.ndarray, source: str) -> list[bytes]:
    """Serialise one TimeReference per use of a link."""
    one = _T["sensor_msgs/msg/TimeReference"](
        header=_HEADER(stamp=_stamp(0), frame_id=""), time_ref=_stamp(0x0102030405060708), source=source
    )
    raw = bytes(STORE.serialize_cdr(one, one.__msgtype__))
    at = raw.index(_split(np.array([0x0102030405060708]))[0].tobytes())
    block = np.tile(np.frombuffer(raw, np.uint8), (len(used), 1))
    block[:, 4:12], block[:, at : at + 8] = _split(used), _split(stamps)
    return [row.tobytes() for row in block]


def _messages(
    log: Recording, spec: dict[str, Any], start: int
) -> Iterator[tuple[str, np.ndarray, list[bytes]]]:
    """Topic, stamps and payloads of all that was recorded."""
    td1, td2 = (ns(spec["timing"][k]) for k in ("td1", "td2"))
    t1, t2 = (start + np.arange(len(a)) * td for a, td in ((log.plant, td1), (log.numerical, td2)))
    x, v, u, F = log.plant[:, :4].T
    none = np.full_like(v, np.nan)
    pair = {
        "position": np.stack([x, u], 1),
        "velocity": np.stack([v, none], 1),
        "effort": np.stack([log.plant[:, W1], F], 1),
    }
    yield "plant/state", t1, joint_states(t1, ["x1", "a1"], **pair)
    x2, v2, w2, F_d = (log.numerical[:, i : i + 1] for i in range(4))
    yield "numerical/state", t2, joint_states(t2, ["x2"], position=x2, velocity=v2, effort=w2)
    yield "numerical/force_reference", t2, joint_states(t2, ["a1"], effort=F_d)
    t3 = start + log.command_stamp
    yield (
        "actuator/command",
        t3,
        joint_states(t3, ["a1"], position=log.command[:, :1], effort=log.command[:, 1:]),
    )
    for i in range(4):
        use, stamp = (start + log.use[i, : log.count[2 + i]]).T
        yield f"links/tau{i + 1}", use, time_references(use, stamp, f"tau{i + 1}")


def write_bag(folder: Path, log: Recording, spec: dict[str, Any], text: str, start: int) -> Path:
    """Write a recording whose first tick was at `start` ns, with `text` on the topic `spec`."""
    topics = list(_messages(log, spec, start))
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        said = _T["std_msgs/msg/String"](data=text)
        connection = writer.add_connection("/rthm/spec", said.__msgtype__, typestore=STORE)
        writer.write(connection, start, STORE.serialize_cdr(said, said.__msgtype__))
        kinds = ["sensor_msgs/msg/JointState"] * 4 + ["sensor_msgs/msg/TimeReference"] * 4
        connections = [
            writer.add_connection(f"/rthm/{t}", k, typestore=STORE)
            for (t, _, _), k in zip(topics, kinds, strict=True)
        ]
        stamps = np.concatenate([s for _, s, _ in topics])
        which = np.repeat(np.arange(len(topics)), [len(s) for _, s, _ in topics])
        payloads = list(chain.from_iterable(p for _, _, p in topics))
        for i in np.argsort(stamps, kind="stable"):
            writer.write(connections[which[i]], int(stamps[i]), payloads[i])
    return folder
