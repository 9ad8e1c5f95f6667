"""``rthm report``: a page about a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Bag, Effects, Json

EXAMPLES = ("rthm report out/bag --out report.html",)


def verb(
    bag: Bag,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.html", help="Where the page goes.")],
    effects: Effects = None,
    json: Json = None,
) -> int:
    """Write a self-contained page about a recorded test."""
    from rthm_analysis.report import write_report
    from rthm_bringup.cli.output import put
    from rthm_core.effects import load_effects

    load_effects(effects or ())
    told = write_report(bag, out)
    outcome, notes = told.outcome, told.recording.notes
    result = {"report": str(out), "verdict": outcome and outcome.as_dict()}
    put(result, [str(out), *(outcome.lines() if outcome else []), *notes], json)
    return 0
