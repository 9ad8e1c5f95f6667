"""Options about who sees the nodes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from rthm_bringup.run.environment import Network

Domain = Annotated[
    int | None,
    typer.Option(
        metavar="N", help="ROS domain; by default ROS_DOMAIN_ID, else 0 with external parts, else a free one."
    ),
]
OpenNetwork = Annotated[
    bool, typer.Option("--network", help="Look for nodes on other hosts; by default only on this one.")
]
Peers = Annotated[
    str,
    typer.Option(
        metavar="ADDRESS,...",
        help="Other hosts that take part, and no others; with --network: hosts that multicast does not "
        "reach.",
    ),
]
Namespace = Annotated[
    str,
    typer.Option(metavar="NAME", help="Namespace of nodes and topics; tests in one domain need their own."),
]


@contextmanager
def network_of(
    domain: int | None, network: bool, peers: str, namespace: str, shared: bool, leads: bool = False
) -> Iterator[Network]:
    """Network of a run, its domain claimed meanwhile.

    Parameters
    ----------
    domain, network, peers, namespace
        The options.
    shared
        Whether others must find the domain without being told.
    leads
        Whether this process leads the test there.

    Raises
    ------
    InputError
        If other hosts are asked for and this one has no network, or another run leads the test.
    """
    from rthm_bringup.run import interfaces
    from rthm_bringup.run.domain import Claim, Leadership, wanted
    from rthm_bringup.run.environment import Network
    from rthm_core.ros.reach import addresses_of

    addresses = tuple(peer.strip() for peer in peers.split(",") if peer.strip())
    addresses_of(addresses)  # told before a node stumbles over it
    if network or addresses:
        interfaces.wait_for_one(lambda text: typer.echo(text, err=True))
    with ExitStack() as claims:
        claim = Claim(wanted(domain, shared or network or bool(addresses)))
        claims.callback(claim.release)
        reach = Network(claim.domain, network, addresses, f"/{namespace.strip('/')}")
        if leads:
            claims.callback(Leadership(reach.domain, reach.namespace).release)
        yield reach
