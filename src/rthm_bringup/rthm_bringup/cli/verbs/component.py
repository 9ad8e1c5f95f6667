"""``rthm component``: what the force of a component follows from, motion in and force out."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.options import Bags, Effects, Json, recording_of

if TYPE_CHECKING:
    from rthm_analysis.component import ComponentFinding

EXAMPLES = (
    "rthm component damper --plot damper.png",
    "rthm component low middle high --input voltage",
)


def verb(
    bags: Bags,
    motion: Annotated[
        str, typer.Option(metavar="NAME", help="Signal that is the imposed motion, where there are several.")
    ] = "",
    force: Annotated[
        str, typer.Option(metavar="NAME", help="Signal that is the measured force, where there are several.")
    ] = "",
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input",
            metavar="NAME",
            help="Further input, such as a voltage; by default all that is there. Can be repeated.",
        ),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", metavar="FILE", help="Draw it as PNG, SVG or PDF.")
    ] = None,
    effects: Effects = None,
    json: Json = None,
) -> int:
    """Find what the force of a component follows from: its motion, and inputs as a voltage."""
    from rthm_analysis.component import identify_recordings
    from rthm_bringup.cli.options import check_picture
    from rthm_bringup.cli.output import put, status

    if plot:
        check_picture(plot)
    recordings = [recording_of(bag, effects) for bag in bags]
    with status("reading") as say:
        found, model, test = identify_recordings(recordings, motion, force, inputs or (), say)
    if plot:
        from rthm_analysis.report.component_picture import draw

        draw(found, model, test, plot)
    put(found.as_dict(), _lines(found), json)
    return 1 if found.verdict in ("improved", "unexplained") else 0


def _lines(found: ComponentFinding) -> Iterator[str]:
    """The answer, its parts with their values, and how good they are."""
    from rthm_analysis.component.words import lag_words, term_words

    yield f"{found.verdict}: {found.words}"
    yield from map(term_words, found.terms)
    yield from (lag_words(name, lag) for name, lag in found.lags.items())
    yield from found.notes
