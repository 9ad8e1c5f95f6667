"""``rthm simulate``: the exact engine, without ROS."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Json, SpecName


class System(StrEnum):
    """What is simulated."""

    hybrid = "hybrid"
    ideal = "ideal"
    taylor = "taylor"


def verb(
    duration: Annotated[float, typer.Option(metavar="S", help="Length of the test in s.")],
    out: Annotated[Path, typer.Option(metavar="FILE.npz", help="Where the trajectory goes.")],
    spec: SpecName = "paper",
    sample: Annotated[
        float | None, typer.Option(metavar="S", help="Time between the rows in s; by default Td1.")
    ] = None,
    system: Annotated[
        System,
        typer.Option(help="hybrid: the loop; ideal: without delays and holds; taylor: the paper's (26)."),
    ] = System.hybrid,
    json: Json = None,
) -> int:
    """Simulate a test exactly; write it to an npz file."""
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import put
    from rthm_bringup.cli.trajectory import final_energies, save
    from rthm_core.engine import simulate

    trajectory = simulate(spec_named(spec), duration, sample, system.value)
    save(trajectory, out)
    energies = final_energies(trajectory)
    lines = [f"{out}", *(f"{name:12s} {value:+.6e} J" for name, value in energies.items())]
    put({"file": str(out), "duration": duration, "system": system.value, "energies": energies}, lines, json)
    return 0
