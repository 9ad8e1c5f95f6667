"""``rthm import``: recordings of other tools as bags."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
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
            help="What a column is, such as position:x1=y: position, velocity, acceleration or load of a "
            "dof, force or motor of an actuator, or another input. Can be repeated.",
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
    offsets: Annotated[
        list[str] | None,
        typer.Option(
            "--offset",
            metavar="ROLE:NAME=NUMBER",
            help="Reading, in the unit of the file, where a signal is zero, such as position:x1=512. Can be "
            "repeated.",
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
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE", help="Draw the first recording as PNG, SVG or PDF."),
    ] = None,
    json: Json = None,
) -> int:
    """Make a bag from CSV, MAT or Parquet files, and say what was understood of them."""
    from rthm_analysis.exchange import import_files, wanted
    from rthm_bringup.cli.options import check_picture
    from rthm_bringup.cli.output import put

    if plot:
        check_picture(plot)
    nominal = spec_named(spec) if spec else None
    said = wanted(maps or (), units or (), time, rate, nominal, offsets or ())
    found = import_files(given, out, said, nominal)
    if plot:
        _draw(found[0], plot)
    put({"bags": [_told(one) for one in found]}, [line for one in found for line in _lines(one)], json)
    return 0


def _draw(one: Imported, path: Path) -> None:
    from rthm_analysis.recording import read_recording
    from rthm_analysis.report.recorded_picture import draw

    draw(read_recording(one.bag).tables, {(c.role, c.name): c.unit for c in one.channels}, path)


def _told(one: Imported) -> dict[str, object]:
    return {
        "bag": str(one.bag),
        "samples": one.samples,
        "duration": one.duration,
        "names": one.names,
        "sampling": one.sampling,
        "channels": [asdict(channel) for channel in one.channels],
        "notes": one.notes,
    }


def _lines(one: Imported) -> Iterator[str]:
    names = ", ".join(one.names)
    yield f"{one.bag}: {one.samples} samples over {one.duration:.6g} s of {names}, {one.sampling}"
    yield from (channel.words for channel in one.channels)
    yield from one.notes
