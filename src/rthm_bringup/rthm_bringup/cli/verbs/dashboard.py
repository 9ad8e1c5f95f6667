"""``rthm dashboard``: a page about a running test."""

from __future__ import annotations

from typing import Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import Effects, Json
from rthm_core.topics import NAMESPACE

EXAMPLES = (
    "rthm dashboard",
    "rthm dashboard --port 9000 --domain 7",
)


def verb(
    port: Annotated[
        int, typer.Option(metavar="N", help="Port of the page on this host; 0: any.", min=0, max=65535)
    ] = 8642,
    effects: Effects = None,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
    json: Json = None,
) -> int:
    """Show a running test in a browser, and its report when it has ended.

    Only this host can open the page, which is renewed ten times a second. A run on this host is found without
    options; for one elsewhere give --domain, --network and so on as for rthm run. The button aborts the test;
    it is no emergency stop. Ctrl-C ends the page, and --json then writes what it showed last.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.output import put
    from rthm_bringup.dashboard.watching import Dashboard
    from rthm_bringup.run.domain import wanted
    from rthm_core.effects import load_effects

    load_effects(effects or ())
    find = wanted(domain, network or bool(peers)) is None
    with network_of(domain if not find else 0, network, peers, namespace, shared=False) as reach:
        dashboard = Dashboard(reach, find, port)
        typer.echo(f"dashboard: {dashboard.server.address} (Ctrl-C ends it)", err=json == "-")
        dashboard.run()
    put(dashboard.hub.shown, [str(dashboard.hub.shown["words"])], json)
    return 0
