"""One node as one process: begin, turn after turn, and a clean end whatever ends it."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TypeVar

import rclpy
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from rthm_core.errors import InputError
from rthm_core.ros import reach
from rthm_core.ros.part import PartNode

N = TypeVar("N", bound=Node)
SAME = 1.0
"""Time within which several signals are one request to end, s."""


def run(build: Callable[[], PartNode]) -> int:
    """Run a node until it is asked to end by SIGINT, SIGTERM or a shutdown.

    The first signal ends the turns, so that motors can still be brought to rest; a later one ends at once.

    Returns
    -------
    int
        Exit status 0; see `built` for another one.
    """
    asked: list[float] = []
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, frame: _ask(asked))
    node = built(build)
    with serving(node), suppress(KeyboardInterrupt):
        while rclpy.ok() and not asked:
            node.turn()
        node.stop()
    return 0


def built(build: Callable[[], N]) -> N:
    """Build the node of this process, and see that only those hear it who may.

    Raises
    ------
    SystemExit
        With status 2 when it cannot be built from what it was given, or is open to others.
    """
    try:
        node = build()
        reach.enforce(node.context.get_domain_id())
    except InputError as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from error
    return node


@contextmanager
def serving(node: Node) -> Iterator[Executor]:
    """Executor of a node; at the end it lets go of the node before the node and its context are destroyed.

    An end of the context while it serves is an end like any other.
    """
    executor = EventsExecutor()
    executor.add_node(node)
    try:
        yield executor
    except ExternalShutdownException:
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


def _ask(asked: list[float]) -> None:
    """Note when it was asked for; the system tells the death of a parent once for each of its threads."""
    asked.append(time.monotonic())
    if asked[-1] > asked[0] + SAME:
        raise KeyboardInterrupt
