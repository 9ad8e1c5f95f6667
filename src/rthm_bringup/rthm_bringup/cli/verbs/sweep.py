"""``rthm sweep``: many loops, on this machine or a Dask cluster."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.options import Json, SpecName, Yes

if TYPE_CHECKING:
    from rthm_analysis.sweep.sweep import Sweep

EXAMPLES = (
    "rthm sweep paper --set timing.tau4=0:0.03:20 --set plant.damping=0.05,0.1 --duration 20",
    "rthm sweep paper --set timing.scale=1:20:100000 --duration 60 --yes",
)


def verb(
    given: Annotated[
        list[str],
        typer.Option(
            "--set",
            metavar="KEY=A:B:N",
            help="Values of a spec entry: a:b:n, a:b:n:log or v,v,...; timing.scale is a factor on all "
            "periods and delays. Can be repeated: all combinations.",
        ),
    ],
    spec: SpecName = "paper",
    draw: Annotated[
        int | None, typer.Option(metavar="N", help="Random draws between a and b instead of a grid.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the draws.")] = 0,
    duration: Annotated[
        float, typer.Option(metavar="S", help="Length of every simulation in s; 0: only stability.")
    ] = 20.0,
    out: Annotated[Path, typer.Option("--out", "-o", metavar="DIR", help="Folder of the results.")] = Path(
        "sweep"
    ),
    workers: Annotated[
        int | None, typer.Option(metavar="N", help="Processes; by default one for each processor.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler, such as tcp://host:8786.")
    ] = None,
    yes: Yes = False,
    json: Json = None,
) -> int:
    """Simulate a loop for many values of its spec.

    Interrupted, the same command continues where it stopped. A sweep of hours says after ten seconds how long
    it takes, for how many loops, and how much of the disk it needs, and on a terminal asks whether to go on.
    """
    from rthm_analysis.sweep.picture import draw as draw_picture
    from rthm_analysis.sweep.points import value_of
    from rthm_analysis.sweep.ranges import given_range
    from rthm_analysis.sweep.run import sweep_over, values_of
    from rthm_bringup.cli.options import spec_named
    from rthm_bringup.cli.output import progress_bar, put
    from rthm_bringup.cli.pace import size_in

    test, ranges = spec_named(spec), [given_range(text) for text in given]
    values = values_of(test, ranges, draw, seed)
    count = values.shape[0]
    size = size_in(out, f"{count} loops of {duration:g} s" if duration else f"{count} loops")
    with progress_bar("loops", count, size, yes=yes, resumes=True) as report:
        done = sweep_over(test, ranges, values, out, duration, workers, scheduler, report)
    picture = out / "sweep.png"
    nominal = [value_of(test, one.key) for one in ranges]
    draw_picture(done.table, ranges, picture, drawn=draw is not None, nominal=nominal)
    put(_result(done, out, picture), _lines(done, out, picture), json)
    return 0


def _result(done: Sweep, out: Path, picture: Path) -> dict[str, object]:
    return {
        "table": str(out / "sweep.parquet"),
        "picture": str(picture),
        "loops": done.loops,
        "found_before": done.found_before,
        "batches": done.batches,
        "rows": done.table.to_pylist(),
    }


def _lines(done: Sweep, out: Path, picture: Path) -> list[str]:
    stable = sum(one is True for one in done.table["stable"].to_pylist())
    refused = [sentence for sentence in done.table["refused"].to_pylist() if sentence]
    before = f"; {done.found_before} of them computed before" if done.found_before else ""
    lines = [
        f"{done.loops} loops, {stable} of them stable{before}",
        f"{out / 'sweep.parquet'}, {picture}",
    ]
    return [*lines, *([f"{len(refused)} were refused, the first: {refused[0]}"] if refused else [])]
