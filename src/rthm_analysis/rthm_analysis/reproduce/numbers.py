"""What a figure or table is: numbers first, and a drawing of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Numbers:
    """The numbers behind a figure.

    Attributes
    ----------
    tables : dict of dict of arrays
        By name of a table: its columns, of one length, by name with unit (``"x1 hybrid [m]"``).
    values : dict of float
        What was found, by name with unit.
    """

    tables: Mapping[str, Mapping[str, Floats]] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {"values": dict(self.values), "tables": {name: dict(t) for name, t in self.tables.items()}}


@dataclass(frozen=True)
class Plate:
    """A figure of the paper: how to compute it, what to say about it, how to draw it.

    Attributes
    ----------
    name, title : str
        File name without ending; heading.
    paper : str
        What the paper says, in a sentence.
    conditional : bool
        Whether it depends on M2 and k3, which cannot be recovered from the paper.
    compute : callable
        Gives the numbers.
    found : callable
        Says what was found, from the numbers alone.
    draw : callable
        Draws the numbers.
    """

    name: str
    title: str
    paper: str
    conditional: bool
    compute: Callable[[], Numbers]
    found: Callable[[Numbers], str]
    draw: Callable[[Numbers], Figure]
