"""Several things within a sentence."""

from __future__ import annotations

from collections.abc import Iterable


def enumerated(parts: Iterable[str]) -> str:
    """``a, b and c``; empty where there is nothing.

    Examples
    --------
    >>> enumerated(["x"]), enumerated(["x", "v", "t"])
    ('x', 'x, v and t')
    """
    *most, last = [*parts] or [""]
    return f"{', '.join(most)} and {last}" if most else last
