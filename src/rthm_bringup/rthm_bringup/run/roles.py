"""The parts of a test: which program each one is, and how it is started."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path

from rthm_core.errors import InputError
from rthm_core.topics import NAMESPACE

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

COMPOSED = ("numerical", "actuator")
"""Nodes that share a process and a thread where that is asked for."""

COORDINATOR = {"coordinator": "rthm_bringup.run.coordinator_node"}
"""What a run in simulated time has in addition."""

COMPOSITION = "rthm_bringup.run.composed"
"""Module that runs several nodes of `LOOP` in one process; their modules are its arguments."""

Value = bool | int | float | str | list[str]


def check(names: frozenset[str]) -> None:
    """Refuse what is not a part of a test."""
    for name in sorted(names - set(PROGRAMS)):
        raise InputError(f"{name!r} is not a part of a test; choose from {', '.join(PROGRAMS)}.")


def command(
    role: str | tuple[str, ...], spec: Path, parameters: Mapping[str, Value], namespace: str = NAMESPACE
) -> list[str]:
    """Command line of the node of a role, or of several in one process.

    Parameters
    ----------
    role
        Key of `PROGRAMS`, or ``coordinator``; or several of `LOOP`.
    spec
        Parameter file.
    parameters
        What the node is told beyond the spec.
    namespace
        Of the node and its topics.
    """
    program = (PROGRAMS | COORDINATOR)[role] if isinstance(role, str) else COMPOSITION
    words = [sys.executable, "-m", program]
    words += [] if isinstance(role, str) else [PROGRAMS[one] for one in role]
    words += ["--ros-args", "-r", f"__ns:={namespace}", "--params-file", str(spec)]
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
        told["bag"] = str(bag.absolute())  # so that who asks for it finds it from anywhere
    return told
