"""``rthm specs``: the tests that come with the package."""

from __future__ import annotations

from typing import Annotated

import typer

from rthm_bringup.cli.options import Json

EXAMPLES = (
    "rthm specs",
    "rthm specs paper > mine.yaml",
)


def verb(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="Print this spec, as a start for your own.")
    ] = None,
    json: Json = None,
) -> int:
    """List the specs that come with the package, or print one."""
    from rthm_bringup.cli.output import put
    from rthm_core.spec import shipped_names, shipped_text

    if name is not None:
        text = shipped_text(name)
        put({"name": name, "text": text}, [text.rstrip("\n")], json)
        return 0
    about = {one: _about(shipped_text(one)) for one in shipped_names()}
    width = max(map(len, about))
    put({"specs": about}, [f"{one.ljust(width)}  {words}" for one, words in about.items()], json)
    return 0


def _about(text: str) -> str:
    """First sentence of the comment with which a spec begins."""
    comment = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        comment.append(line.removeprefix("#").strip())
    return " ".join(comment).partition(". ")[0].rstrip(".") + "."
