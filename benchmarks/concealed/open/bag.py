"""The recording of a plant alone: `plant/state` and the spec."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from benchmarks.concealed.bag import STORE, joint_states
from rosbags.rosbag2 import StoragePlugin, Writer


def write_plain_bag(
    folder: Path,
    stamps: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray | None,
    load: np.ndarray | None,
    drive: str,
    text: str,
) -> Path:
    """Write position (n,), velocity and known load, where there are any, at `stamps` (ns).

    The load is the effort of the dof or, with a name in `drive`, that of an entry of its own.
    """
    none = np.full_like(position, np.nan)
    names = ["x1", drive] if drive else ["x1"]
    efforts = ([none, load] if drive else [load]) if load is not None else [none]
    columns = {"position": np.stack([position, none][: len(names)], 1), "effort": np.stack(efforts, 1)}
    if velocity is not None:
        columns["velocity"] = np.stack([velocity, none][: len(names)], 1)
    payloads = joint_states(stamps, names, **columns)
    said = STORE.types["std_msgs/msg/String"](data=text)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        spec = writer.add_connection("/rthm/spec", said.__msgtype__, typestore=STORE)
        state = writer.add_connection("/rthm/plant/state", "sensor_msgs/msg/JointState", typestore=STORE)
        writer.write(spec, int(stamps[0]), STORE.serialize_cdr(said, said.__msgtype__))
        for stamp, payload in zip(stamps, payloads, strict=True):
            writer.write(state, int(stamp), payload)
    return folder
