"""One thing that a driver owes to a test, and whether it does it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """Result of one check.

    Attributes
    ----------
    name : str
    passed : bool
    value : float
        The figure that was judged.
    unit : str
        Its unit; empty for counts.
    words : str
        The figure and what is allowed, for the eye.
    """

    name: str
    passed: bool
    value: float
    unit: str
    words: str
