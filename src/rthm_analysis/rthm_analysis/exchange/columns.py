"""Columns of a file with their units: what every file format is read into and written from."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

Column = np.ndarray[tuple[Any, ...], np.dtype[Any]]

_UNIT = re.compile(r"^(?P<name>.*\S)\s*[\[(](?P<unit>[^\])]*)[\])]$")


@dataclass(frozen=True)
class Columns:
    """Named columns.

    Attributes
    ----------
    source : str
        Where they come from, for sentences about them.
    values : dict of (n,) arrays
        By name; whole nanoseconds are integers, everything else float, NaN where a value is missing.
    units : dict of str
        Units that the file states.
    period : float or None
        Seconds from sample to sample, where the file states that in place of a time column.
    """

    source: str
    values: Mapping[str, Column]
    units: Mapping[str, str] = field(default_factory=dict)
    period: float | None = None

    def heading(self, name: str) -> str:
        """Name with its unit, as in ``x1.position [m]``."""
        unit = self.units.get(name, "")
        return f"{name} [{unit}]" if unit else name


def split_heading(heading: str) -> tuple[str, str]:
    """Name and unit of ``x1.position [m]`` or ``Force (kN)``; the unit is empty where there is none."""
    found = _UNIT.match(heading.strip())
    return (found["name"], found["unit"].strip()) if found else (heading.strip(), "")


def named(headings: list[str]) -> tuple[list[str], dict[str, str]]:
    """Different names for all columns of a file, and the units in their headings."""
    split = [split_heading(one) for one in headings]
    names = [name or str(number + 1) for number, (name, _) in enumerate(split)]
    often = Counter(names)
    unique = [f"{name} ({k + 1})" if often[name] > 1 else name for k, name in enumerate(names)]
    return unique, {name: unit for name, (_, unit) in zip(unique, split, strict=True) if unit}
