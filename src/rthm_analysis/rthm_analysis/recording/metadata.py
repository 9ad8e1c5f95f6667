"""What rosbag2 wants to know of a bag beside its messages: ``metadata.yaml``, version 9."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Any

import yaml

VERSION = 9
FOREVER = {"sec": 9223372036, "nsec": 854775807}


@dataclass
class Topic:
    """One topic of a bag: name, type, quality of service offered, and what was written of it.

    ``channel`` is its number in the MCAP file, ``sequence`` the number of the last message.
    """

    name: str
    type: str
    depth: int = 10
    latched: bool = False
    channel: int = 0
    count: int = 0
    sequence: int = 0

    def qos(self) -> list[dict[str, Any]]:
        """Quality of service as rosbag2 writes it, so that a replay offers what the node offered."""
        return [
            {
                "history": "keep_last",
                "depth": self.depth,
                "reliability": "reliable",
                "durability": "transient_local" if self.latched else "volatile",
                "deadline": dict(FOREVER),
                "lifespan": dict(FOREVER),
                "liveliness": "automatic",
                "liveliness_lease_duration": dict(FOREVER),
                "avoid_ros_namespace_conventions": False,
            }
        ]


@dataclass
class Summary:
    """Totals of a bag with one file; times in ns."""

    file: str
    topics: list[Topic] = field(default_factory=list)
    first: int = 0
    last: int = 0
    custom: dict[str, str] = field(default_factory=dict)

    @property
    def count(self) -> int:
        """Messages of all topics."""
        return sum(topic.count for topic in self.topics)

    def as_dict(self) -> dict[str, Any]:
        """Content of ``rosbag2_bagfile_information``."""
        start = {"nanoseconds_since_epoch": self.first}
        duration = {"nanoseconds": self.last - self.first}
        file = {"path": self.file, "starting_time": start, "duration": duration, "message_count": self.count}
        return {
            "version": VERSION,
            "storage_identifier": "mcap",
            "relative_file_paths": [self.file],
            "duration": duration,
            "starting_time": start,
            "message_count": self.count,
            "topics_with_message_count": [
                {"topic_metadata": _topic_metadata(topic), "message_count": topic.count}
                for topic in self.topics
            ],
            "compression_format": "",
            "compression_mode": "",
            "files": [file],
            "custom_data": self.custom or None,
            "ros_distro": "jazzy",
        }

    def as_yaml(self, *, root: bool) -> str:
        """YAML text; with `root` as in ``metadata.yaml``, else as inside the MCAP file."""
        content = self.as_dict()
        return yaml.dump(
            {"rosbag2_bagfile_information": content} if root else content, Dumper=_Plain, sort_keys=False
        )


class _Plain(yaml.SafeDumper):
    """YAML without anchors: rosbag2's own reader is the reader to please."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _topic_metadata(topic: Topic) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type,
        "serialization_format": "cdr",
        "offered_qos_profiles": topic.qos(),
        "type_description_hash": definition(topic.type)[1],
    }


def qos_text(topic: Topic) -> str:
    """Quality of service as the text that a channel of an MCAP file carries."""
    return yaml.dump(topic.qos(), Dumper=_Plain, sort_keys=False)


@cache
def definition(type_name: str) -> tuple[str, str]:
    """Return the full text of a message definition and its hash (RIHS01).

    Parameters
    ----------
    type_name
        As ``sensor_msgs/msg/JointState``.
    """
    text, _ = _types().generate_msgdef(type_name, ros_version=2)
    return text, _types().hash_rihs01(type_name)


@cache
def _types() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)
