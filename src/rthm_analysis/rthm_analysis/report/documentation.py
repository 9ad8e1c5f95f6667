"""Where the documentation is, for links from a page to what explains it."""

from __future__ import annotations

import os
from pathlib import Path

VARIABLE = "RTHM_DOCS"
"""Environment variable with the address of the site; empty: no links."""

CHECKOUT = Path(__file__).resolve().parents[4]


def address(part: str) -> str:
    """Address of a part of the documentation; empty where there is none.

    Without `VARIABLE` it is in the checkout that this package runs from: the site that ``scripts/docs`` has
    made, or else the pages it is made from.

    Parameters
    ----------
    part : str
        Page without its ending, and heading in it, as ``time#a-sample-under-way``.
    """
    page, _, heading = part.partition("#")
    site = os.environ.get(VARIABLE)
    if site is not None:
        return f"{site.rstrip('/')}/{page}.html#{heading}" if site else ""
    files = (CHECKOUT / "out" / "docs" / f"{page}.html", CHECKOUT / "docs" / f"{page}.md")
    return next((f"{file.as_uri()}#{heading}" for file in files if file.is_file()), "")
