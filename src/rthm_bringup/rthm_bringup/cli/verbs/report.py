"""``rthm report``: a page about a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Bag, Json


def verb(
    bag: Bag,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.html", help="Where the page goes.")],
    json: Json = None,
) -> int:
    """Write a self-contained page about a recorded test."""
    from rthm_analysis.report import write_report
    from rthm_bringup.cli.output import put

    write_report(bag, out)
    put({"report": str(out)}, [str(out)], json)
    return 0
