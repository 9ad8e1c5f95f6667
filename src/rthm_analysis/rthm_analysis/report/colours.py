"""Colours of all pages, as page.css names them."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files

NAMED = re.compile(r"(--[\w-]+): (#[0-9a-f]{6})\b")


@cache
def palette() -> dict[str, str]:
    """Light colours by their name in the style sheet, as ``--ink``.

    Plots are made with these. In the dark the page replaces each by what its name stands for there, so that
    no two names may share a colour.
    """
    style = (files(__package__) / "page.css").read_text(encoding="utf-8")
    return dict(NAMED.findall(style.partition("@media")[0]))


INK, MUTED, GRID, AXIS, PAPER = (palette()[f"--{name}"] for name in ("ink", "muted", "grid", "axis", "paper"))

COLOURS = tuple(palette()[f"--curve-{k}"] for k in range(1, 9))
"""Colours that people with any colour vision tell apart (Okabe and Ito)."""
