"""``rthm reproduce``: every figure and table of the paper."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Json, Yes

EXAMPLES = ("rthm reproduce --out paper",)


def verb(
    out: Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Folder for page and pictures.")],
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="FIGURE", help="Draw this figure alone, such as figure08; can be repeated."),
    ] = None,
    yes: Yes = False,
    json: Json = None,
) -> int:
    """Compute every figure and table of the paper, on one page."""
    from rthm_analysis.reproduce import reproduce
    from rthm_bringup.cli.output import progress_bar, put
    from rthm_bringup.cli.pace import size_in

    figures = f"{len(only)} of the figures, and the tables" if only else "every figure and table"
    with progress_bar("reproducing", 1.0, size_in(out, figures), yes=yes) as report:
        result = reproduce(out, only or (), report)
    put(result.as_dict(), [str(result.page)], json)
    return 0
