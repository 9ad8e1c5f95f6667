"""``rthm pretension``: wires brought to their pretension by hand, on measured force."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import Json, SpecName, Wait
from rthm_bringup.run.stopped import StoppedError
from rthm_core.topics import NAMESPACE

LOOK, LAST = 0.5, 2.0
"""How long the load cells are read at each step, and at the end, s."""

EXAMPLES = ("rthm pretension rig.yaml -o tensioned.yaml",)


def verb(
    spec: SpecName = "paper",
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE", help="Where to write the spec with the tension.")
    ] = Path("tensioned.yaml"),
    patience: Annotated[
        float, typer.Option(metavar="S", help="How long tightening may take.", min=1.0, max=86400.0)
    ] = 600.0,
    wait: Wait = 30.0,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
    json: Json = None,
) -> int:
    """Guide the operator while tightening the wires to the pretension of the spec.

    Zero the sensors with slack wires first (rthm zero). No motor is commanded. Exit status 1 when the
    pretension is not reached, or a force passes its limit.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import put_spec
    from rthm_bringup.driver.tightening import approach, wires
    from rthm_bringup.driver.zeroing import at_rig, rest_of, slack_zero, tensioned
    from rthm_core.limits import require_limits

    test = spec_named(spec)
    test.loop()
    require_limits(test)
    slack = slack_zero(test)
    with (
        network_of(domain, network, peers, namespace, shared=True, leads=True) as reach,
        at_rig(reach) as conductor,
    ):
        from rthm_bringup.run.zero import tell_zero

        rest_of(conductor, slack, 0.0, wait)  # the driver is there
        try:
            tell_zero(conductor, slack)
            deadline = time.monotonic() + patience
            why = approach(
                slack,
                lambda: rest_of(conductor, slack, LOOK, wait),
                lambda words: typer.echo(words, err=True),
                lambda: time.monotonic() > deadline,
            )
            found = rest_of(conductor, slack, LAST, wait)
            done = tensioned(slack, found)
            if not why:
                tell_zero(conductor, done)
        except StoppedError as stopped:
            why, found, done = str(stopped), [], slack
    told = wires(slack, found) if found else []
    tension = {one.name: one.tension for one in told}
    return put_spec(done, out, why, {"tension": tension}, (one.line for one in told), json)
