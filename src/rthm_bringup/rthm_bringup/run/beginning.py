"""The common begin of the nodes of a test: agreed upon, then every node is activated before it comes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from rthm_bringup.run import roles
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.question import ACTIVE
from rthm_bringup.run.stopped import RefusedError, StoppedError
from rthm_core.clock import NS

HEAD_STARTS = (1, 4, 16)
"""From the agreement on the begin to the begin, s: a host too busy for the first is given more."""


def begin_together(
    conductor: Conductor,
    names: Sequence[str],
    duration: float,
    aligned: Callable[[int], int] = lambda earliest: earliest,
    late: Callable[[str], None] = lambda sentence: None,
) -> int:
    """Activate nodes so that the clocks of all start at one instant of the wall clock.

    The recorder is activated last: its bag holds one test, and it closes for good when it is deactivated.

    Parameters
    ----------
    names
        Nodes that wait to be activated.
    duration
        Length of the test, s; 0: until the nodes are deactivated.
    aligned
        Chooses the begin, given the earliest one; both ns.
    late
        Told a sentence when nodes were not active in time and a later begin is chosen.

    Returns
    -------
    int
        The begin, ns of the wall clock.

    Raises
    ------
    StoppedError
        When a node refuses for another reason, or no begin was far enough ahead.
    """
    for head_start in HEAD_STARTS:
        begin = aligned(time.time_ns() + head_start * NS)
        conductor.set({name: {"start_time": begin, "duration": duration} for name in names})
        if _activated(begin, conductor, names):
            return begin
        _undo(conductor, names)
        late(f"the nodes were not active {head_start} s after the begin was chosen")
    raise StoppedError("The nodes were not active at the start time; this host or the network is too busy.")


def _activated(begin: int, conductor: Conductor, names: Sequence[str]) -> bool:
    """Activate all nodes, the recorder when all others were in time; each refuses a begin that has passed."""
    try:
        conductor.step("activate", [name for name in names if name != "recorder"])
        conductor.step("activate", [name for name in names if name == "recorder"])
    except RefusedError:
        if time.time_ns() < begin:
            raise
        return False
    return True


def _undo(conductor: Conductor, names: Sequence[str]) -> None:
    """Deactivate what was active in time; motors come to rest while the plant still moves."""
    states = conductor.states(names)
    for name in (*reversed(roles.LOOP), "analysis"):
        if states.get(name) == ACTIVE:
            conductor.step("deactivate", [name])
