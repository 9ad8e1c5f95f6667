"""``rthm compare``: recordings, trajectories and specs beside each other."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.options import Json, SpecOfBag

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rthm_analysis.comparison import Comparison

EXAMPLES = ("rthm compare ideal.npz out/first --tolerance 2 --out compared.html",)


def verb(
    sources: Annotated[
        list[str],
        typer.Argument(
            metavar="A B ...",
            help="Two or more recordings (bag, or folder of a run), trajectories (.npz) or specs; the first "
            "is the reference.",
        ),
    ],
    tolerance: Annotated[
        float | None,
        typer.Option(
            metavar="PERCENT",
            help="Largest difference that passes: its rms in % of that of the reference; above it, exit "
            "status 1.",
        ),
    ] = None,
    only: Annotated[
        str, typer.Option(metavar="SIGNAL,...", help="Compare only these, such as x1,a1.force.")
    ] = "",
    duration: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            help="How long specs are simulated, in s; by default as long as the longest of the others.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE.html", help="Write a page about it.")
    ] = None,
    spec: SpecOfBag = None,
    json: Json = None,
) -> int:
    """Compare two or more tests.

    Differences, delays and amplitudes by signal; tracking, delays of the links and energy by test.

    Exit status 0; 1 when --tolerance is exceeded; 2 for bad input.
    """
    from rthm_analysis.comparison import compare, motions_at
    from rthm_bringup.cli.output import put, status

    with status("reading"):
        motions = motions_at(sources, duration, spec or None)
    names = [name.strip() for name in only.split(",") if name.strip()]
    found = compare(motions, None if tolerance is None else tolerance / 100.0, names)
    if out is not None:
        from rthm_analysis.report.comparison import write_comparison

        write_comparison(found, out)
    page = {"page": str(out) if out else None}
    put(found.as_dict() | page, [*_lines(found), *([str(out)] if out else []), found.words], json)
    return 1 if found.within is False else 0


def _lines(found: Comparison) -> Iterator[str]:
    """Tables: differences by signal, tracking, delays, energy."""
    from rthm_analysis.comparison.rows import (
        delay_rows,
        difference_rows,
        energy_rows,
        seconds,
        tracking_rows,
    )
    from rthm_bringup.cli.output import table

    for told, one in zip(found.told[1:], found.against, strict=True):
        yield f"{told.motion.words} against {found.reference.words}, {one.begin:.4g} to {one.end:.4g} s"
        yield from table(difference_rows(one))
        yield f"time offset: {seconds(one.offset)}"
        yield ""
    for rows in (tracking_rows(found), delay_rows(found), energy_rows(found)):
        if rows:
            yield from table(rows)
            yield ""
    yield from dict.fromkeys(note for told in found.told for note in told.motion.notes)
