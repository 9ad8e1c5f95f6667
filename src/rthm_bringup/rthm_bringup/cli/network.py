"""Options about who sees the nodes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
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
    str, typer.Option(metavar="ADDRESS,...", help="Other hosts, where the network does not pass multicast.")
]


@contextmanager
def network_of(domain: int | None, network: bool, peers: str, shared: bool) -> Iterator[Network]:
    """Network of a run, its domain claimed meanwhile.

    Parameters
    ----------
    domain, network, peers
        The options.
    shared
        Whether others must find the domain without being told.

    Raises
    ------
    InputError
        If other hosts are asked for and this one has no network.
    """
    from rthm_bringup.run import interfaces
    from rthm_bringup.run.domain import Claim, wanted
    from rthm_bringup.run.environment import Network

    addresses = tuple(peer.strip() for peer in peers.split(",") if peer.strip())
    if network or addresses:
        interfaces.wait_for_one(lambda text: typer.echo(text, err=True))
    claim = Claim(wanted(domain, shared or network or bool(addresses)))
    try:
        yield Network(claim.domain, network, addresses)
    finally:
        claim.release()
