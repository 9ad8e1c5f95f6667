"""``rthm run``: the node graph as processes, recorded."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.network import Domain, Namespace, OpenNetwork, Peers
from rthm_bringup.cli.options import Amplitude, Effects, Json, SpecName
from rthm_core.topics import NAMESPACE

if TYPE_CHECKING:
    from rthm_core.spec import Spec

EXAMPLES = (
    "rthm run paper --duration 20",
    "rthm run paper --duration 20 --virtual --out out",
    "rthm run rig.yaml --duration 60 --plant external --amplitude 0.1",
)


class Plant(StrEnum):
    """Who provides the plant."""

    simulated = "simulated"
    external = "external"


def verb(
    spec: SpecName = "paper",
    duration: Annotated[
        float, typer.Option(metavar="S", help="Length of the test in s; 0: until Ctrl-C.")
    ] = 20.0,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder for recording, report and logs.", show_default="out/DATE_TIME"
        ),
    ] = None,
    virtual: Annotated[
        bool,
        typer.Option("--virtual", help="Simulated time in lock step: deterministic, faster than real time."),
    ] = False,
    plant: Annotated[
        Plant,
        typer.Option(help="external: a driver that runs already, of hardware or not, publishes plant/state."),
    ] = Plant.simulated,
    external: Annotated[
        str,
        typer.Option(metavar="PART,...", help="Parts that run elsewhere, started there with rthm node PART."),
    ] = "",
    wait: Annotated[
        float, typer.Option(metavar="S", help="How long to wait for external parts.", min=0.0)
    ] = 300.0,
    allow_clock_offset: Annotated[
        bool,
        typer.Option(
            "--allow-clock-offset",
            help="Run even if the clocks of hosts differ by more than limits.clock; the analysis "
            "corrects for it.",
        ),
    ] = False,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="Run everything, but send commands only to actuator/command_dry."),
    ] = False,
    heartbeat: Annotated[
        bool,
        typer.Option(
            "--heartbeat",
            help="Require an operator's heartbeat: the test waits for it, and aborts without it.",
        ),
    ] = False,
    compose: Annotated[
        bool,
        typer.Option(
            "--compose", help="Numerical side and controller in one process, for less work per tick."
        ),
    ] = False,
    unstable: Annotated[
        bool,
        typer.Option("--unstable", help="Move a real machine even if the loop is unstable."),
    ] = False,
    amplitude: Amplitude = 1.0,
    effects: Effects = None,
    domain: Domain = None,
    network: OpenNetwork = False,
    peers: Peers = "",
    namespace: Namespace = NAMESPACE,
    priority: Annotated[
        int | None,
        typer.Option(min=0, max=99, help="Real-time priority of the loop, if the system grants it."),
    ] = None,
    json: Json = None,
) -> int:
    """Run a test as ROS 2 nodes, record it and report.

    The key a aborts the test. Exit status 0 when it ended, with or without missed deadlines; 1 when a node
    died or data were lost; 2 for bad input; 3 when it was aborted.
    """
    from rthm_bringup.cli.network import network_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import put
    from rthm_bringup.run.perform import perform
    from rthm_bringup.run.plan import Plan, new_folder
    from rthm_core.spec import scaled_motion

    parts = frozenset(part.strip() for part in external.split(",") if part.strip())
    if plant is Plant.external:
        parts |= {"plant"}
    test = scaled_motion(spec_named(spec, effects), amplitude)
    _warn(test, refused=plant is Plant.external and not (unstable or dry_run))
    with network_of(domain, network, peers, namespace, shared=bool(parts), leads=True) as reach:
        plan = Plan(
            test,
            out or new_folder(),
            duration,
            reach,
            virtual,
            parts,
            priority,
            wait,
            allow_clock_offset,
            hardware=plant is Plant.external,
            dry_run=dry_run,
            heartbeat=heartbeat,
            compose=compose,
        )
        result = perform(plan)
    put(result.as_dict(), result.lines(), json)
    return result.status


def _warn(test: Spec, *, refused: bool) -> None:
    """Warn of an unstable loop, or a delay longer than its motion; InputError where neither may start."""
    from rthm_bringup.unstable import refuse, warn_of_delays, warn_of_growth

    if refused:
        refuse(test)
        return
    warn_of_delays(test)
    warn_of_growth(test)
