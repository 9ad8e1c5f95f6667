"""One node as one process, or several: begin, turn after turn, and a clean end whatever ends it."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Protocol, TypeVar

import rclpy
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from rthm_core.errors import InputError
from rthm_core.ros import reach
from rthm_core.ros.agenda import Position

N = TypeVar("N", bound=Node)
ONE_REQUEST = 1.0
"""Time within which several signals are one request to end, s."""


class Worker(Protocol):
    """A node that does one thing after the other when it is asked to."""

    def turn(self) -> bool:
        """Do what is next; return whether now is a good moment for work that can wait."""
        ...

    def next(self) -> Position:
        """Place of what is next."""
        ...

    def attend(self) -> None:
        """Do what can wait."""
        ...

    def stop(self) -> None:
        """Come to rest."""
        ...


def run(*builds: Callable[[], Worker]) -> int:
    """Run a node until it is asked to end by SIGINT, SIGTERM or a shutdown.

    The first signal ends the turns, so that motors can still be brought to rest; a later one ends at once.

    Parameters
    ----------
    builds
        Builds the node; with several, all their nodes share one executor and one thread.

    Returns
    -------
    int
        Exit status 0; see `built` for another one.
    """
    asked: list[float] = []
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, frame: _ask(asked))
    nodes = [built(build) for build in builds]
    with serving(*nodes), suppress(KeyboardInterrupt):
        while rclpy.ok() and not asked:
            take_turn(nodes)
        for node in reversed(nodes):
            node.stop()
    return 0


def take_turn(nodes: Sequence[Worker]) -> None:
    """Do what is next of all that nodes of one process have to do, and let the others say that they live."""
    first = nodes[0] if len(nodes) == 1 else min(nodes, key=lambda node: node.next())
    if first.turn():
        for node in nodes:
            node.attend()


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
def serving(*nodes: Node) -> Iterator[Executor]:
    """Executor of nodes; at the end it lets go of them before they and their context are destroyed.

    An end of the context while it serves is an end like any other.
    """
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
    try:
        yield executor
    except ExternalShutdownException:
        pass
    finally:
        executor.shutdown()
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown()


def _ask(asked: list[float]) -> None:
    """Note when it was asked for; the system tells the death of a parent once for each of its threads."""
    asked.append(time.monotonic())
    if asked[-1] > asked[0] + ONE_REQUEST:
        raise KeyboardInterrupt
