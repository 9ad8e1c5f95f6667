"""``rthm simulate``: the exact engine, without ROS."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Json, SpecName
from rthm_core.errors import InputError


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
        System, typer.Option(help="hybrid: the loop; ideal: without delays and holds; taylor: (26).")
    ] = System.hybrid,
    json: Json = None,
) -> int:
    """Simulate a test exactly; write it to an npz file."""
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import progress_bar, put, table
    from rthm_bringup.cli.trajectory import all_energies, save
    from rthm_core.engine import simulate

    test = spec_named(spec)
    if not out.parent.is_dir():
        raise InputError(f"{out.parent} is no folder, so {out.name} cannot be written there; make it first.")
    with progress_bar("simulating", duration) as report:
        trajectory = simulate(test, duration, sample, system.value, progress=report)
    save(trajectory, out)
    energies = {name: float(values[-1]) for name, values in all_energies(trajectory).items()}
    result = {"file": str(out), "duration": duration, "system": system.value, "energies": energies}
    put(result, [str(out), *table((name, f"{value:+.6e} J") for name, value in energies.items())], json)
    return 0
