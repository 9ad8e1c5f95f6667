"""``rthm zero``: what the sensors of a rig at rest read becomes their zero."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import Json, SpecName, Wait
from rthm_bringup.run.stopped import StoppedError
from rthm_core.topics import NAMESPACE

EXAMPLES = ("rthm zero rig.yaml -o zeroed.yaml",)


def verb(
    spec: SpecName = "paper",
    out: Annotated[
        Path, typer.Option("--out", "-o", metavar="FILE", help="Where to write the spec with the zero.")
    ] = Path("zeroed.yaml"),
    only: Annotated[
        str,
        typer.Option(
            metavar="KIND,...", help="Kinds of sensor that are zeroed: position, velocity, motor, force."
        ),
    ] = "position,velocity,motor,force",
    seconds: Annotated[
        float, typer.Option(metavar="S", help="How long the sensors are read.", min=0.5, max=600.0)
    ] = 3.0,
    wait: Wait = 30.0,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
    json: Json = None,
) -> int:
    """Zero load cells and encoders with the rig at rest and unloaded.

    Nothing is commanded. In every run with the spec that is written, the driver subtracts these offsets. Exit
    status 1 when the rig is not at rest, or its driver accepts no zero.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import put_spec
    from rthm_bringup.driver.rest import unrest
    from rthm_bringup.driver.zeroing import at_rig, rest_of, zeroed
    from rthm_core.limits import require_limits

    test = spec_named(spec)
    kinds = _kinds(only)
    test.loop()
    require_limits(test)
    with (
        network_of(domain, network, peers, namespace, shared=True, leads=True) as reach,
        at_rig(reach) as conductor,
    ):
        from rthm_bringup.run.zero import tell_zero

        raw = test.model_copy(update={"zero": None})
        rest_of(conductor, test, 0.0, wait)  # the driver is there
        tell_zero(conductor, raw)
        found = rest_of(conductor, test, seconds, wait)
        done, why = zeroed(test, found, kinds), unrest(found)
        if not why:
            try:
                tell_zero(conductor, done)
            except StoppedError as stopped:
                why = str(stopped)
    lines = (one.line for one in found if one.channel.kind in kinds)
    zero = done.zero.model_dump() if done.zero and not why else None
    return put_spec(done, out, why, {"zero": zero}, lines, json)


def _kinds(text: str) -> frozenset[str]:
    from rthm_actuator.sensors import SENSORS
    from rthm_core.errors import refusal

    kinds = frozenset(one.strip() for one in text.split(",") if one.strip())
    if not kinds or kinds - set(SENSORS):
        raise refusal("--only", text, f"one or more of {', '.join(SENSORS)}")
    return kinds
