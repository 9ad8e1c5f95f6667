"""A number with unit, bounds and a description.

The one definition behind validation, ROS descriptors and the reference pages.
"""

from __future__ import annotations

import math
import numbers
import re
from dataclasses import dataclass

from rthm_core.errors import RefusedError

LARGEST_NUMBER = 1e12
"""Size of a number of a test, SI: more is a slip of the unit or the exponent."""


@dataclass(frozen=True)
class Quantity:
    """What a number means and which values it may have.

    Parameters
    ----------
    unit
        SI unit as text, ``"N s/m"``; ``"1"`` for a pure number. ``signal`` stands for the unit of the signal
        that an effect acts on.
    description
        One sentence for a test engineer.
    minimum, maximum
        Bounds, themselves allowed.
    above, below
        Bounds, themselves not allowed.
    default
        Value when nothing is said; None: must be given.
    """

    unit: str
    description: str
    minimum: float | None = None
    maximum: float | None = None
    above: float | None = None
    below: float | None = None
    default: float | None = None

    @property
    def bounds(self) -> str:
        """Bounds in words, ``"above 0"``; empty without bounds."""
        bounds = {"above": self.above, "at least": self.minimum, "at most": self.maximum, "below": self.below}
        return " and ".join(f"{word} {bound:g}" for word, bound in bounds.items() if bound is not None)

    @property
    def lowest(self) -> float | None:
        """Lower bound, allowed or not."""
        return self.minimum if self.above is None else self.above

    @property
    def highest(self) -> float | None:
        """Upper bound, allowed or not."""
        return self.maximum if self.below is None else self.below

    @property
    def allowed(self) -> str:
        """What may be given, as the end of "must be ..."."""
        unit = "" if self.unit == "1" else f" in {self.unit}"
        return " ".join(f"a finite number {self.bounds}".split()) + unit

    @property
    def largest(self) -> float:
        """Largest size; none for what multiplies a power of motion.

        Where a rig moves by micrometres, a spring that hardens by a per cent has 1e13 N/m^3.
        """
        return math.inf if "/m^" in self.unit else LARGEST_NUMBER

    def convert(self, value: object) -> float:
        """Return `value` as a float; integers and text such as ``1e-3`` (a string to YAML 1.1) are numbers.

        Raises
        ------
        RefusedError
            If it is not a finite number within the bounds, or its size is above `largest`.
        """
        number = as_number(value)
        if number is None or not math.isfinite(number) or not self.holds(number):
            raise RefusedError(value, self.allowed)
        if abs(number) > self.largest:
            raise RefusedError(value, f"{self.allowed} of a size up to {self.largest:g}")
        return number

    def holds(self, number: float) -> bool:
        """Whether `number` is within the bounds."""
        return (
            (self.minimum is None or number >= self.minimum)
            and (self.maximum is None or number <= self.maximum)
            and (self.above is None or number > self.above)
            and (self.below is None or number < self.below)
        )


@dataclass(frozen=True)
class Text:
    """An entry that is text."""

    description: str
    longest: int = 200

    allowed = "text of 1 to 200 printable characters"

    def convert(self, value: object) -> str:
        """Return `value` if it is text that fits one line; else raise RefusedError."""
        if isinstance(value, str) and value.strip() and value.isprintable() and len(value) <= self.longest:
            return value
        way_out = "put it in quotes" if isinstance(value, bool | int | float) else ""
        raise RefusedError(value, self.allowed, way_out)


_NUMBER = re.compile(r"[-+]?(\d+\.\d*|\.\d+|0|[1-9]\d*)([eE][-+]?\d+)?", re.ASCII)


def as_number(value: object) -> float | None:
    """Float of a number or of the text of one; None of anything else, truth values included.

    Octal and hexadecimal text is not a number: ROS and YAML read it differently.
    """
    if isinstance(value, bool):
        return None
    if isinstance(value, str) and not _NUMBER.fullmatch(value):
        return None
    if isinstance(value, numbers.Real | str):
        try:
            return float(value)
        except (ValueError, OverflowError):
            return None
    return None
