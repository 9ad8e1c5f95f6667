"""``rthm node``: one part of a test on this host."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import SpecName
from rthm_core.topics import NAMESPACE

EXAMPLES = ("rthm node plant rig.yaml --network",)


def verb(
    part: Annotated[
        str, typer.Argument(metavar="PART", help="plant, numerical, actuator, analysis or recorder.")
    ],
    spec: SpecName = "paper",
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of the recording; for the recorder.", show_default="out/DATE_TIME"
        ),
    ] = None,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
    priority: Annotated[
        int | None,
        typer.Option(min=0, max=99, help="Real-time priority of the loop, if the system grants it."),
    ] = None,
) -> int:
    """Start one part of a test on this host.

    It waits until rthm run --external PART takes control, on this host or another.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.run.alone import become

    test = spec_named(spec)
    with network_of(domain, network, peers, namespace, shared=True) as reach:
        become(part, test, reach, out, priority)
