"""Which ROS a run uses, and the environment of its processes.

The wheels set the loader's path and a guard variable for their own process: handed down, these would keep a
child from finding its libraries. A ROS that is sourced in the same shell would mix its libraries with theirs;
beside wheels it is left out.
"""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rthm_core.errors import InputError
from rthm_core.ros import reach
from rthm_core.topics import NAMESPACE

GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
PROFILES, RANGE = "FASTRTPS_DEFAULT_PROFILES_FILE", "ROS_AUTOMATIC_DISCOVERY_RANGE"
BUILTIN = "FASTDDS_BUILTIN_TRANSPORTS"
CLOSED, DISCOVERY = (Path(__file__).with_name(name) for name in ("closed.xml", "discovery.xml"))
"""Settings of Fast DDS: for nodes of this host only, and for others; a user's own replace the latter."""

ELSEWHERE = ("ROS_LOCALHOST_ONLY", "ROS_DISCOVERY_SERVER", "ROS_SUPER_CLIENT", "FASTDDS_ENVIRONMENT_FILE")
"""Other ways in which an environment changes who finds whom; empty, they change nothing."""

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
        Whether nodes on all other hosts are looked for.
    peers
        Addresses of other hosts: only these are used, or with `open` these also where multicast does not
        pass. With neither, nothing leaves or enters this host.
    namespace
        Where the nodes and topics of the run are.
    """

    domain: int
    open: bool = False
    peers: tuple[str, ...] = ()
    namespace: str = NAMESPACE

    def __post_init__(self) -> None:
        if not 0 <= self.domain <= 232:
            raise InputError(
                f"The domain is {self.domain}, but must be between 0 and 232; choose another one."
            )
        if not re.fullmatch(r"(/[A-Za-z_][A-Za-z0-9_]*)+", self.namespace) or "__" in self.namespace:
            raise InputError(
                f"The namespace is {self.namespace!r}, but must be words of letters, digits and _ with /"
                " between them, as in /rig_1; choose another one."
            )

    @property
    def reach(self) -> str:
        """Whom the nodes take packets from, in the words of `rthm_core.ros.reach`."""
        if self.open:
            return reach.OPEN
        return reach.NAMED if self.peers else reach.HOST

    def place(self) -> str:
        """Say where the nodes are."""
        aside = "" if self.namespace == NAMESPACE else f", namespace {self.namespace}"
        return f"domain {self.domain}{aside}"

    def words(self) -> str:
        """Say who can take part."""
        if self.open:
            return "open: anybody on the network can hear this test and take part in it"
        return f"this host and {', '.join(self.peers)}" if self.peers else "this host only"

    def variables(self) -> dict[str, str]:
        """Environment variables that say this to ROS; the user's own count on an open network only."""
        told = {"ROS_DOMAIN_ID": str(self.domain), reach.VARIABLE: self.reach}
        if self.open:
            own = os.environ.get(PROFILES, str(CLOSED))
            told |= {RANGE: "SUBNET", PROFILES: own if own not in ("", str(CLOSED)) else str(DISCOVERY)}
        else:
            told |= dict.fromkeys(ELSEWHERE, "") | {"SKIP_DEFAULT_XML_FILE": "1", BUILTIN: "DEFAULT"}
            told |= {RANGE: "SYSTEM_DEFAULT", PROFILES: str(CLOSED), reach.PEERS: ""}
        if self.peers:
            told[reach.PEERS] = ";".join(self.peers)
        if self.reach == reach.NAMED:
            told |= {RANGE: "LOCALHOST", PROFILES: str(DISCOVERY)}
        return told
