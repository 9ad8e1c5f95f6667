"""``rthm check-driver``: whether a driver keeps to what a test asks of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import Json, SpecName
from rthm_bringup.topics import NAMESPACE

if TYPE_CHECKING:
    from rthm_bringup.driver.check import Check


def verb(
    spec: SpecName = "paper",
    seconds: Annotated[
        float, typer.Option(metavar="S", help="How long to listen.", min=0.1, max=3600.0)
    ] = 5.0,
    wait: Annotated[
        float, typer.Option(metavar="S", help="How long to wait for a sample.", min=0.0, max=3600.0)
    ] = 10.0,
    swing: Annotated[
        float,
        typer.Option(
            metavar="M",
            help="Move all motors this far and back, in m, and see whether they follow; 0: nothing moves.",
        ),
    ] = 0.0,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
    json: Json = None,
) -> int:
    """Check whatever publishes plant/state: names, sizes, numbers, stamps, period, ages, delivery.

    Exit status 0 when every check is passed, else 1.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import put, status
    from rthm_bringup.driver.checking import check_driver

    test = spec_named(spec)
    test.loop()
    with network_of(domain, network, peers, namespace, shared=True) as reach, status("listening"):
        checks = check_driver(test, reach, seconds, wait, swing)
    passed = all(one.passed for one in checks)
    put({"passed": passed, "checks": [vars(one) for one in checks]}, map(_line, checks), json)
    return 0 if passed else 1


def _line(one: Check) -> str:
    return f"{'passed' if one.passed else 'FAILED':7} {one.name}: {one.words}"
