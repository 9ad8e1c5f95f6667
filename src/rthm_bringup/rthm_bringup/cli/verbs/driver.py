"""``rthm driver``: a rig as the plant of tests."""

from __future__ import annotations

from typing import Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import SpecName
from rthm_core.topics import NAMESPACE

EXAMPLES = (
    "rthm driver rig.yaml --python my_rig.py:Rig",
    "rthm driver rig.yaml --udp 192.168.0.20:5000",
)


def verb(
    spec: SpecName = "paper",
    python: Annotated[
        str, typer.Option(metavar="FILE.py:CLASS", help="A class with read() and command(u).")
    ] = "",
    udp: Annotated[
        str, typer.Option(metavar="HOST[:PORT]", help="A device with the protocol of docs/udp.md.")
    ] = "",
    ros2_control: Annotated[
        str,
        typer.Option(
            metavar="NAME=JOINT,...", help="A rig under ros2_control: the joint of each name in the spec."
        ),
    ] = "",
    order: Annotated[
        str, typer.Option(metavar="JOINT,...", help="Joints of the command controller, in its order.")
    ] = "",
    dead_time: Annotated[
        float, typer.Option(metavar="S", help="Time from a command to its effect, a part of tau4.", min=0.0)
    ] = 0.0,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
) -> int:
    """Run a driver that serves any test started with --plant external.

    The rig moves only while a test runs, and only within the limits of the spec. Ctrl-C ends the driver.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.run.alone import become_driver
    from rthm_core.errors import InputError
    from rthm_core.limits import require_limits

    words = {
        "driver": [python],
        "udp": [udp],
        "ros2_control": ["--joints", ros2_control, "--order", order],
    }
    asked = [kind for kind, given in zip(words, (python, udp, ros2_control), strict=True) if given]
    if len(asked) != 1:
        raise InputError("A driver serves one rig; give exactly one of --python, --udp and --ros2-control.")
    test = spec_named(spec)
    test.loop()
    require_limits(test)
    arguments = [*words[asked[0]], "--dead-time", str(dead_time)]
    with network_of(domain, network, peers, namespace, shared=True) as reach:
        become_driver(asked[0], test, reach, arguments)
