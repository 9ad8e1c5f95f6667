"""``rthm new``: a first spec, from a shipped one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from rthm_bringup.cli.options import Json

EXAMPLES = (
    "rthm new mine.yaml",
    "rthm new decay.yaml --like decay",
)


def verb(
    path: Annotated[Path, typer.Argument(metavar="PATH", help="The spec, a file that is not there yet.")],
    like: Annotated[
        str | None, typer.Option(metavar="NAME", help="Shipped spec to start from; by default paper.")
    ] = None,
    json: Json = None,
) -> int:
    """Write a first spec, with unit and meaning of every entry, to be corrected."""
    from rthm_bringup.cli.output import put
    from rthm_core.files import check_new, write_whole
    from rthm_core.spec.first import LIKE, first_spec

    check_new("PATH", path)
    name = like or LIKE
    text = first_spec(name)
    write_whole(path, text)
    put({"spec": str(path), "like": name}, [str(path)], json)
    return 0
