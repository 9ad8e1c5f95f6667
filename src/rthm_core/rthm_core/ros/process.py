"""One node as one process: begin, turn after turn, and a clean end whatever ends it."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from types import FrameType

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions

from rthm_core.errors import InputError
from rthm_core.ros.part import PartNode


def run(build: Callable[[], PartNode]) -> int:
    """Run a node until it is asked to end by SIGINT, SIGTERM or a shutdown.

    The first signal ends the turns, so that motors can still be brought to rest; a second one ends at once.

    Returns
    -------
    int
        Exit status: 0, or 2 when the node cannot be built from what it was given.
    """
    asked: list[int] = []
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, frame: _ask(asked, number, frame))
    try:
        node = build()
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        while rclpy.ok() and not asked:
            node.turn()
        node.stop()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


def _ask(asked: list[int], number: int, frame: FrameType | None) -> None:
    if asked:
        raise KeyboardInterrupt
    asked.append(number)
