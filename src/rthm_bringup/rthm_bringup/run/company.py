"""Nodes of another test where this one is to take place: a run begins only where it is alone.

Runs of one host keep out of each other's way by a lock (`rthm_bringup.run.domain`). What else there may be, a
run on another host or nodes that somebody started by hand, shows on the graph.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable

from rthm_bringup.run.environment import Network
from rthm_core.errors import InputError
from rthm_core.ros.reach import HOST

Nodes = Iterable[tuple[str, str]]
"""Names and namespaces of nodes."""

LOOK, LOOK_FAR = 0.5, 2.0
"""How long to look for nodes of this host, and of others, s."""


def look_at(network: Network) -> float:
    """How long to look at the graph before somebody who is there has been seen, s."""
    return LOOK if network.reach == HOST else LOOK_FAR


def company(nodes: Nodes, namespace: str, alone: Collection[str], own: Collection[str]) -> list[str]:
    """Names of nodes that are there and must not be.

    Parameters
    ----------
    namespace
        That of the test.
    alone
        Names of all nodes of the test, its leader included.
    own
        Those of them that are there rightly, once.
    """
    there = Counter(name for name, where in nodes if where == namespace and name in alone)
    return sorted(name for name, count in there.items() if count > (name in own))


def refuse_company(nodes: Nodes, network: Network, alone: Collection[str], own: Collection[str]) -> None:
    """Refuse to go on beside nodes of another test, with an InputError."""
    found = company(nodes, network.namespace, alone, own)
    if found:
        raise InputError(
            f"Another test is in {network.place()}: {', '.join(found)}; wait for its end (20 s more where it"
            " was killed), or choose another --namespace or --domain."
        )
