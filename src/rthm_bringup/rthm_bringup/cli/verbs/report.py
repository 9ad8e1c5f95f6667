"""``rthm report``: a page about a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Bag, Effects, Json, SpecOfBag, recording_of

EXAMPLES = ("rthm report out/bag --out report.html",)


def verb(
    bag: Bag,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.html", help="Where to write the page.")],
    spec: SpecOfBag = None,
    effects: Effects = None,
    json: Json = None,
) -> int:
    """Write a self-contained page about a recorded test."""
    from rthm_analysis.report import write_report
    from rthm_bringup.cli.output import put

    shown = write_report(recording_of(bag, effects, spec), out)
    outcome, notes = shown.outcome, shown.recording.notes
    result = {"report": str(out), "verdict": outcome and outcome.as_dict()}
    put(result, [str(out), *(outcome.lines() if outcome else []), *notes], json)
    return 0
