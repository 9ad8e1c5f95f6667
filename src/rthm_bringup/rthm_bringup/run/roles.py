"""The parts of a test: which program each one is, and how it is started."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from rthm_bringup.topics import NAMESPACE
from rthm_core.errors import InputError

PROGRAMS = {
    "plant": "rthm_plant_sim.node",
    "numerical": "rthm_numerical.node",
    "actuator": "rthm_actuator.node",
    "analysis": "rthm_analysis.node",
    "recorder": "rthm_bringup.recorder_node",
}
"""Module of each node, by the name of the node."""

LOOP = ("plant", "numerical", "actuator")
"""Nodes that make up the loop; the others watch it."""

OBSERVERS = frozenset({"analysis"})
"""Nodes that may go without the test being ended."""

COORDINATOR = {"coordinator": "rthm_bringup.run.coordinator_node"}
"""What a run in simulated time has in addition."""

Value = bool | int | float | str | list[str]


def check(names: frozenset[str]) -> None:
    """Refuse what is no part of a test."""
    for name in sorted(names - set(PROGRAMS)):
        raise InputError(f"{name!r} is no part of a test; choose from {', '.join(PROGRAMS)}.")


def command(role: str, spec: Path, parameters: Mapping[str, Value], namespace: str = NAMESPACE) -> list[str]:
    """Command line of the node of a role.

    Parameters
    ----------
    role
        Key of `PROGRAMS`, or ``coordinator``.
    spec
        Parameter file.
    parameters
        What the node is told beyond the spec.
    namespace
        Of the node and its topics.
    """
    words = [sys.executable, "-m", (PROGRAMS | COORDINATOR)[role], "--ros-args", "-r", f"__ns:={namespace}"]
    words += ["--params-file", str(spec)]
    for name, value in parameters.items():
        words += ["-p", f"{name}:={json.dumps(value)}"]
    return words


def parameters(
    role: str, spec: Path, bag: Path | None, virtual: bool, priority: int | None
) -> dict[str, Value]:
    """What a node of this role is told at its start, beyond the spec."""
    told: dict[str, Value] = {"virtual": virtual}
    if role in LOOP and priority is not None:
        told["priority"] = priority
    if role in LOOP and virtual:
        told |= {"priority": 0, "lock_memory": False}
    if role == "recorder" and (virtual or priority == 0):
        told["priority"] = 0
    if role in ("recorder", "coordinator"):
        told["spec_file"] = str(spec)
    if role == "recorder" and bag is not None:
        told["bag"] = str(bag)
    return told
