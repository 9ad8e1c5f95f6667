"""Which ROS a run uses, and the environment of its processes.

The wheels set the loader's path and a guard variable for their own process: handed down, these would keep a
child from finding its libraries. A ROS that is sourced in the same shell would mix its libraries with theirs;
beside wheels it is left out.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rthm_core.errors import InputError

GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
PROFILES, RANGE = "FASTRTPS_DEFAULT_PROFILES_FILE", "ROS_AUTOMATIC_DISCOVERY_RANGE"
PROFILE = Path(__file__).with_name("discovery.xml")
"""Settings of Fast DDS, which a user's own replace."""

SOURCED = ("AMENT_PREFIX_PATH", "AMENT_CURRENT_PREFIX", "COLCON_PREFIX_PATH", "ROS_DISTRO", "ROS_VERSION")


def has_wheels() -> bool:
    """Whether this Python has its own ROS from wheels."""
    return importlib.util.find_spec("ros_wheels_bootstrapper") is not None


def ros_in_words(environment: Mapping[str, str] = os.environ) -> str:
    """Say which ROS is in use."""
    other = environment.get("ROS_DISTRO")
    if not has_wheels():
        return f"ROS 2 {other or '(not sourced)'}"
    return "ROS 2 jazzy from wheels" + (f", the sourced {other} left aside" if other else "")


def without_parents_ros(
    environment: Mapping[str, str], wheels: bool, prefix: str = sys.prefix
) -> dict[str, str]:
    """Environment in which a child finds one ROS: that of the wheels if there are any, else the sourced one.

    Parameters
    ----------
    environment
        The one of this process.
    wheels
        Whether the child has ROS from wheels.
    prefix
        Where the wheels are installed.
    """
    kept = dict(environment)
    kept.pop(GUARD, None)
    if not wheels:
        return kept
    foreign = [prefix, "/opt/ros", *kept.get("AMENT_PREFIX_PATH", "").split(os.pathsep)]
    for name in SOURCED:
        kept.pop(name, None)
    for name in ("LD_LIBRARY_PATH", "PYTHONPATH"):
        paths = [path for path in kept.pop(name, "").split(os.pathsep) if path and not _below(path, foreign)]
        if paths:
            kept[name] = os.pathsep.join(paths)
    return kept


def _below(path: str, roots: list[str]) -> bool:
    return any(root and Path(path).is_relative_to(root) for root in roots)


@dataclass(frozen=True)
class Network:
    """Who can see the nodes of a run.

    Parameters
    ----------
    domain
        ROS domain id, 0 to 232.
    open
        Whether nodes on other hosts are looked for; by default only this host.
    peers
        Addresses of other hosts, for networks that do not pass multicast.
    """

    domain: int
    open: bool = False
    peers: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not 0 <= self.domain <= 232:
            raise InputError(
                f"The domain is {self.domain}, but must be between 0 and 232; choose another one."
            )

    def variables(self) -> dict[str, str]:
        """Environment variables that say this to ROS; what the user has set of profile and range stays."""
        opened = bool(self.open or self.peers)
        found = {
            "ROS_DOMAIN_ID": str(self.domain),
            PROFILES: os.environ.get(PROFILES) or str(PROFILE),
            RANGE: "SUBNET" if opened else os.environ.get(RANGE) or "LOCALHOST",
        }
        if self.peers:
            found["ROS_STATIC_PEERS"] = ";".join(self.peers)
        return found
