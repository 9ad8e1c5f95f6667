"""A term of a formula with the values of its numbers, in words."""

from __future__ import annotations

import re
from typing import NamedTuple

from rthm_analysis.diagnosis.numbers import bare, number
from rthm_analysis.diagnosis.result import Value
from rthm_core.effects.possible import UNSURE

WINDOW = re.compile(r"\((\w) < t\)(?: \* \(t < (\w)\))?")
"""Factor of a term that acts from an instant on, or between two."""


class Written(NamedTuple):
    """A term as it was fitted: its formula, and the values of its numbers."""

    text: str
    values: dict[str, Value]

    def told(self, *, with_std: bool) -> str:
        """The formula with its values, maybe with the standard deviations of those that are determined."""

        def value(name: re.Match[str]) -> str:
            one = self.values[name[0]]
            told = number(one.value, one.std, "", signed=True)
            is_sure = with_std and one.std < UNSURE * abs(one.value) and "+-" in told
            return f"({told})" if is_sure else bare(one.value, 4)

        names = "|".join(self.values)
        return re.sub(rf"\b({names})\b", value, self.text).replace("- -", "+ ").replace("+ -", "- ")

    @property
    def numbers(self) -> dict[str, float]:
        """Values of its numbers."""
        return {name: one.value for name, one in self.values.items()}

    def interval(self, end: float) -> tuple[float, float] | None:
        """When it acts, s, in a recording of this length; None: throughout."""
        window = WINDOW.search(self.text)
        if window is None:
            return None
        first, last = window.groups()
        until = self.values[last].value if last else end
        return max(self.values[first].value, 0.0), min(until, end)
