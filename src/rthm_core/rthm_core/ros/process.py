"""One node as one process: begin, turn after turn, and a clean end whatever ends it."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation

from rthm_core.errors import InputError
from rthm_core.ros.lifecycle import LoopNode


def run(build: Callable[[], LoopNode]) -> int:
    """Run a node until it is asked to end by SIGINT, SIGTERM or a shutdown.

    Returns
    -------
    int
        Exit status: 0, or 2 when the node cannot be built from what it was given.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Python's exception would abort the executor
    rclpy.init()
    try:
        node = build()
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        while rclpy.ok():
            node.turn()
    except ExternalShutdownException:
        pass
    except rclpy_implementation.RCLError:
        if rclpy.ok():
            raise
    finally:
        node.close()
        node.destroy_node()
        rclpy.try_shutdown()
    return 0
