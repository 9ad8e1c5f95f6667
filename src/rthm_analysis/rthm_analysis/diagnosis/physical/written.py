"""A term of a formula with the values of its numbers, in words."""

from __future__ import annotations

import re
from typing import NamedTuple

from rthm_analysis.diagnosis.numbers import bare, number
from rthm_analysis.diagnosis.result import Value
from rthm_core.effects.possible import UNSURE

BEGIN, END = re.compile(r"\((\w) < t\)"), re.compile(r"\(t < (\w)\)")
"""Factors of a term that acts from an instant on, and until one."""


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
        begins, ends = BEGIN.search(self.text), END.search(self.text)
        if begins is None and ends is None:
            return None
        begin = self.values[begins[1]].value if begins else 0.0
        until = self.values[ends[1]].value if ends else end
        return max(begin, 0.0), min(until, end)
