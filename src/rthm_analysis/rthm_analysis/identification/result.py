"""What was found of a rig: figures with their uncertainty, what is wrong, and the spec that says so."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from rthm_core.spec import apply, write_spec

if TYPE_CHECKING:
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Figure:
    """A number that was measured, or the reason why it was not.

    Attributes
    ----------
    name
        What it is of, as ``k_tot of a1``.
    unit
        SI.
    value, std
        The number and its standard deviation; NaN: not determined.
    claimed
        What the spec has there; None: nothing.
    words
        What there is to say beside the figures.
    """

    name: str
    unit: str
    value: float = math.nan
    std: float = math.nan
    claimed: float | None = None
    words: str = ""

    @property
    def known(self) -> bool:
        """Whether there is a number."""
        return math.isfinite(self.value)

    @property
    def line(self) -> str:
        """All of it, for the eye."""
        if not self.known:
            return f"{self.name}: not determined, {self.words}"
        spec = "" if self.claimed is None else f" (the spec has {self.claimed:.6g})"
        words = f"; {self.words}" if self.words else ""
        return f"{self.name}: {self.value:.6g} +- {self.std:.2g} {self.unit}{spec}{words}"


@dataclass(frozen=True)
class Identified:
    """A rig as it was measured.

    Attributes
    ----------
    figures : tuple of Figure
    wrong : tuple of str
        What contradicts the spec in a way that no value of it mends, as a sign; one sentence each, with the
        way out.
    changes : dict
        Entries of the spec with their new values.
    """

    figures: tuple[Figure, ...]
    wrong: tuple[str, ...] = ()
    changes: dict[str, Any] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """What is printed."""
        return [*(figure.line for figure in self.figures), *self.wrong]

    def as_dict(self) -> dict[str, Any]:
        """What is told as JSON."""
        return {
            "figures": [asdict(figure) for figure in self.figures],
            "wrong": list(self.wrong),
            "changes": self.changes,
        }

    def written(self, spec: Spec) -> str:
        """Text of the spec with what was measured; the figures stand above it."""
        told = [f"# {figure.line}" for figure in self.figures]
        return "\n".join([*told, write_spec(apply(spec, self.changes))])
