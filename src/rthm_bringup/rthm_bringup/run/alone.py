"""One part of a test on this host, for a test that is spread over several."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import NoReturn

from rthm_bringup.run import roles
from rthm_bringup.run.environment import Network, has_wheels, without_parents_ros
from rthm_bringup.run.plan import new_folder
from rthm_core.errors import InputError
from rthm_core.spec import Spec, write_spec


def become(role: str, spec: Spec, network: Network, out: Path | None, priority: int | None) -> NoReturn:
    """Replace this process by the node of a role, which then waits to be led.

    Parameters
    ----------
    role
        Key of `roles.PROGRAMS`.
    spec, network
        The same on every host.
    out
        Folder in which the recorder makes ``bag``; None: a new one.
    priority
        Real-time priority that a node of the loop asks for.
    """
    roles.check(frozenset({role}))
    bag = (out or new_folder()) / "bag"
    if bag.exists() and any(bag.iterdir()):
        raise InputError(f"{bag} has a recording already, and none is overwritten; name another --out.")
    file = _kept_open(write_spec(spec))
    told = roles.parameters(role, file, bag.absolute() if role == "recorder" else None, False, priority)
    environment = without_parents_ros(os.environ, has_wheels()) | network.variables()
    print(f"{role} is in {network.place()}; Ctrl-C ends it.", file=sys.stderr, flush=True)
    os.execve(sys.executable, roles.command(role, file, told, network.namespace), environment)


def become_driver(kind: str, spec: Spec, network: Network, arguments: list[str]) -> NoReturn:
    """Replace this process by a driver, which then waits for tests.

    Parameters
    ----------
    kind
        Package of `rthm_plant_sim`: ``driver``, ``udp`` or ``ros2_control``.
    spec, network
        The same as those of its tests.
    arguments
        What the driver is told beside the spec.
    """
    file = _kept_open(write_spec(spec))
    environment = without_parents_ros(os.environ, has_wheels()) | network.variables()
    print(f"the driver is in {network.place()}; Ctrl-C ends it.", file=sys.stderr, flush=True)
    words = [sys.executable, "-m", f"rthm_plant_sim.{kind}", str(file), *arguments]
    os.execve(sys.executable, [*words, "--ros-args", "-r", f"__ns:={network.namespace}"], environment)


def _kept_open(text: str) -> Path:
    """File without a name that lives as long as the process, whatever ends it."""
    descriptor = os.memfd_create("spec", 0)
    os.write(descriptor, text.encode())
    return Path(f"/proc/self/fd/{descriptor}")
