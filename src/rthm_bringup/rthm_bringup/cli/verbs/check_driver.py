"""``rthm check-driver``: whether a driver keeps to what a test asks of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import Json, SpecName, Wait
from rthm_core.topics import NAMESPACE

if TYPE_CHECKING:
    from rthm_bringup.driver.check import Check

EXAMPLES = (
    "rthm check-driver rig.yaml --seconds 10",
    "rthm check-driver rig.yaml --measure measured.yaml",
)


def verb(
    spec: SpecName = "paper",
    seconds: Annotated[
        float, typer.Option(metavar="S", help="How long to listen.", min=0.1, max=3600.0)
    ] = 5.0,
    wait: Wait = 10.0,
    swing: Annotated[
        float,
        typer.Option(
            metavar="M",
            help="Also move all motors this far and back, in m, and check that they follow; 0: nothing "
            "moves.",
        ),
    ] = 0.0,
    measure: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Instead, move the motors a little, measure stiffness, delay, poles, signs and noise, "
            "and write them as a spec.",
        ),
    ] = None,
    travel: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            help="With --measure: amplitude of this motion about the present positions, in m; by default "
            "a quarter of what the limits allow.",
        ),
    ] = None,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
    json: Json = None,
) -> int:
    """Check whether a driver does what a test needs.

    Names, sizes, numbers, stamps, period, ages and delivery of plant/state, whoever publishes it. Exit status
    0 when every check is passed, else 1. --measure checks nothing: it is a run, with the exit status of one,
    and 1 also when no spec was written.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import put, status
    from rthm_bringup.driver.checking import check_driver

    test = spec_named(spec)
    test.loop()
    if measure is not None:
        from rthm_bringup.driver.measuring import measure as measured

        with network_of(domain, network, peers, namespace, shared=True, leads=True) as reach:
            found = measured(test, reach, measure, seconds, wait, travel)
        put(found.as_dict(), found.lines(), json)
        return found.status
    with network_of(domain, network, peers, namespace, shared=True) as reach, status("listening"):
        checks = check_driver(test, reach, seconds, wait, swing)
    passed = all(one.passed for one in checks)
    put({"passed": passed, "checks": [vars(one) for one in checks]}, map(_line, checks), json)
    return 0 if passed else 1


def _line(one: Check) -> str:
    return f"{'passed' if one.passed else 'FAILED':7} {one.name}: {one.words}"
