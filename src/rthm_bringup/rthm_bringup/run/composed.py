"""Several nodes of the loop in one process.

``python -m rthm_bringup.run.composed MODULE ... --ros-args ...``: they share one thread, which does what is
due next of all that they have to do.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rthm_core.ros.part import PartNode

ROS = "--ros-args"
"""First argument that is not a module."""


def node_of(module: str) -> type[PartNode]:
    """Class of the node that a module has as its program, `Node` there."""
    found: type[PartNode] = import_module(module).Node
    return found


def main() -> int:
    """Run the nodes of the named modules until they are asked to end."""
    from rthm_core.ros.process import run

    words = sys.argv[1:]
    return run(*(node_of(module) for module in words[: words.index(ROS)]))


if __name__ == "__main__":
    sys.exit(main())
