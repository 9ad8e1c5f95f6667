"""``rthm import``: recordings of other tools as bags."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.options import Json, spec_named

if TYPE_CHECKING:
    from rthm_analysis.exchange import Imported

EXAMPLES = (
    "rthm import decay.csv -o decay --map position:x1=Displacement --unit position=mm --spec rig.yaml",
)


def verb(
    given: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE ...",
            help="CSV, MAT or Parquet; a folder from rthm export; or a name of nonlinear_benchmarks.",
        ),
    ],
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="DIR", help="The bag, or a folder for several.")
    ],
    maps: Annotated[
        list[str] | None,
        typer.Option(
            "--map",
            metavar="ROLE:NAME=COLUMN",
            help="What a column is, such as position:x1=y: position, velocity or load of a dof, force or "
            "motor of an actuator. Can be repeated.",
        ),
    ] = None,
    units: Annotated[
        list[str] | None,
        typer.Option(
            "--unit",
            metavar="ROLE=UNIT",
            help="Unit in the file, such as position=mm or time=ms; or a factor to SI, such as "
            "force=35.15. Can be repeated.",
        ),
    ] = None,
    time: Annotated[str | None, typer.Option(metavar="COLUMN", help="The column with the time.")] = None,
    rate: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Samples per second, if there is no column with the time."),
    ] = None,
    spec: Annotated[
        str | None,
        typer.Option("--spec", metavar="SPEC", help="Spec that goes into the bag: the nominal model."),
    ] = None,
    json: Json = None,
) -> int:
    """Make a bag from CSV, MAT or Parquet files."""
    from rthm_analysis.exchange import import_files, wanted
    from rthm_bringup.cli.output import put

    nominal = spec_named(spec) if spec else None
    found = import_files(given, out, wanted(maps or (), units or (), time, rate, nominal), nominal)
    put({"bags": [_told(one) for one in found]}, [line for one in found for line in _lines(one)], json)
    return 0


def _told(one: Imported) -> dict[str, object]:
    return {
        "bag": str(one.bag),
        "samples": one.samples,
        "duration": one.duration,
        "names": one.names,
        "notes": one.notes,
    }


def _lines(one: Imported) -> Iterator[str]:
    yield f"{one.bag}: {one.samples} samples over {one.duration:.6g} s of {', '.join(one.names)}"
    yield from one.notes
