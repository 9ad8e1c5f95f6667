"""A first spec in the making."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from rthm_analysis.identification import Figure
from rthm_core.spec import spec_from_parameters
from rthm_core.spec.first import first_text

if TYPE_CHECKING:
    from rthm_core.spec import Spec

LEAST, MOST = 1e-3, 100.0
"""Relative standard deviations between which an uncertainty is: no estimate is better than the assumption
that the plant is linear."""
DIGITS, COMPUTED_DIGITS = 6, 9
"""Digits of numbers that were estimated, and of those that were computed with."""
UNTOLD = "Placeholder: the recording does not show it. Put in the value of your rig."


@dataclass
class Draft:
    """A first spec in the making.

    Attributes
    ----------
    parameters : dict
        Entries by dotted name.
    notes : dict of str
        What to say of them in the file.
    figures : list of Figure
        Numbers of the plant, with their standard deviations.
    told : list of str
        What the recording does not say, one sentence each.
    """

    parameters: dict[str, Any] = field(default_factory=dict)
    notes: dict[str, str] = field(default_factory=dict)
    figures: list[Figure] = field(default_factory=list)
    told: list[str] = field(default_factory=list)

    @property
    def spec(self) -> Spec:
        """The spec."""
        return spec_from_parameters(self.parameters)

    def text(self, source: str) -> str:
        """Text of the spec, with comments."""
        head = f"First spec of the recording {source}: check every entry, and correct what you know better."
        return first_text(self.spec, head, self.notes)

    def untold(self, what: str, *keys: str) -> None:
        """Note that some entries are placeholders."""
        self.told.append(what)
        self.notes |= dict.fromkeys(keys, UNTOLD)


def uncertainty_of(relative: float) -> float:
    """A relative standard deviation as an uncertainty of the spec."""
    return rounded(min(max(relative, LEAST), MOST), 3)


def rounded(value: float, digits: int) -> float:
    """A number with so many digits."""
    return float(f"{value:.{digits}g}")
