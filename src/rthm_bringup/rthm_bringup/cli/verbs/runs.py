"""``rthm runs``: an index of the tests in a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Json

EXAMPLES = ("rthm runs out --sort error --out out/index.html",)


def verb(
    folder: Annotated[
        Path, typer.Argument(metavar="[FOLDER]", help="Folder of the runs.", show_default="out")
    ] = Path("out"),
    sort: Annotated[
        str,
        typer.Option(
            metavar="BY", help="Order: date (newest first), name, spec, length, error, outcome or problems."
        ),
    ] = "date",
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE.html", help="Write the index as a page.")
    ] = None,
    json: Json = None,
) -> int:
    """List the runs and trajectories in a folder.

    Of each: date, spec, length, outcome, error, problems.
    """
    from rthm_analysis.runs import runs_in, sorted_runs
    from rthm_analysis.runs.rows import rows
    from rthm_bringup.cli.output import put, table

    found = sorted_runs(runs_in(folder), sort)
    if out is not None:
        from rthm_analysis.report.runs import write_runs

        write_runs(found, folder, out)
    said = [f"{run.name}: {one}" for run in found for one in run.problems]
    lines = table(rows(found)) if found else [f"{folder} has no runs yet."]
    result = {
        "folder": str(folder),
        "runs": [run.as_dict() for run in found],
        "page": str(out) if out else None,
    }
    put(result, [*lines, *(["", *said] if said else []), *([str(out)] if out else [])], json)
    return 0
