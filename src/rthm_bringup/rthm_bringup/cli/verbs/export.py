"""``rthm export``: a bag as files of other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Bag, Json, SpecOfBag, recording_of

EXAMPLES = (
    "rthm export out/bag -o tables",
    "rthm export out/bag -o motion.csv --rate 100",
)


def verb(
    bag: Bag,
    out: Annotated[
        Path,
        typer.Option(
            "-o",
            "--out",
            metavar="PATH",
            help="A folder: one file per topic, every sample. A .csv, .mat or .parquet: one table, every "
            "signal held between its samples.",
        ),
    ],
    form: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="Files of a folder: csv, mat or parquet.")
    ] = "csv",
    rate: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Rows per second of one table; else the instants of plant/state."),
    ] = None,
    spec: SpecOfBag = None,
    json: Json = None,
) -> int:
    """Write a recording as CSV, MAT or Parquet, with units."""
    from rthm_analysis.exchange import export_bag
    from rthm_bringup.cli.output import put

    recording = recording_of(bag, spec=spec)
    files = [str(file) for file in export_bag(recording, out, form, rate)]
    put({"files": files}, [*files, *recording.notes], json)
    return 0
