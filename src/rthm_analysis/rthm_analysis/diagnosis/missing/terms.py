"""A term of a formula: its size, a factor that is known, and shapes over one or two variables."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.missing.shapes import Shape
from rthm_core.effects.formula import NUMBERS, evaluated

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


KNOWN = frozenset(
    {("1", "1", ""), ("x", "1", ""), ("v", "1", ""), ("sign(v)", "1", "")}
    | {("1", shape, "x") for shape in ("w", "w**2", "w**3")}
    | {("1", shape, "x") for shape in ("max(w - p, 0)", "max(p - w, 0)", "sign(w) * max(abs(w) - p, 0)")}
    | {("1", shape, "v") for shape in ("w", "w * abs(w)")}
)
"""Factor, shape and variable of constant load, spring, damper, dry friction, springs that bend, stops, play
and drag.
"""

Over = tuple[str, Shape]
"""A variable and a shape over it."""


@dataclass(frozen=True)
class Term:
    """A force of a size, a known factor, and shapes over one or two variables.

    Attributes
    ----------
    site : str
        Name of the place at which it acts.
    carrier : str
        Known factor, as a formula.
    shapes : tuple of (str, Shape)
        Variables and the shapes over them; one, or two.
    size : float
        N over the unit of all factors.
    gain : float
        Squared error that it removes where the fit did not see it (cross-validated), beside the terms before
        it.
    """

    site: str
    carrier: str
    shapes: tuple[Over, ...]
    size: float = 0.0
    gain: float = 0.0

    @property
    def depends_on(self) -> tuple[str, ...]:
        """Its variables."""
        own = [over for over, shape in self.shapes if shape.text != "1"]
        carried = [one for one in ("x", "v", "load") if re.search(rf"\b{one}\b", self.carrier)]
        return tuple(dict.fromkeys([*carried, *own]))

    @property
    def is_known(self) -> bool:
        """Whether it is the law of a kind of the library."""
        over, shape = self.shapes[0]
        return len(self.shapes) == 1 and (
            (self.carrier, shape.text, "" if shape.text == "1" else over) in KNOWN
        )

    @property
    def is_constant(self) -> bool:
        """Whether it depends on nothing."""
        return not self.depends_on

    @property
    def factors(self) -> str:
        """All factors as a formula of the variables, with the numbers b, c and so on."""
        names, found = iter(NUMBERS[1:]), [self.carrier]
        for over, shape in self.shapes:
            numbers = {number: next(names) for number, _ in zip("pq", shape.numbers, strict=False)}
            found.append(_named(shape.text, numbers | {"w": over}))
        return " * ".join(one for one in found if one != "1") or "1"

    @property
    def with_values(self) -> str:
        """All factors as a formula of the variables, with the values of the numbers."""
        names = "|".join(NUMBERS)
        return re.sub(rf"\b({names})\b", lambda word: f"({self.numbers[word[0]]!r})", self.factors)

    @property
    def formula(self) -> str:
        """The whole, with the numbers a, b and so on."""
        size, factors = NUMBERS[0], self.factors
        if factors == "1":
            return size
        return f"{size} {factors[2:]}" if factors.startswith("1 / ") else f"{size} * {factors}"

    @property
    def within(self) -> tuple[float, ...]:
        """Numbers within its shapes."""
        return tuple(value for _, shape in self.shapes for value in shape.numbers)

    @property
    def steps(self) -> tuple[float, ...]:
        """How far these may be off."""
        return tuple(step for _, shape in self.shapes for step in shape.steps)

    @property
    def numbers(self) -> dict[str, float]:
        """Values of the numbers of its formula."""
        return dict(zip(NUMBERS, (self.size, *self.within), strict=False))

    def moved(self, within: Iterable[float]) -> Term:
        """The same with other numbers within its shapes."""
        values = iter(within)
        shapes = tuple(
            (over, shape._replace(numbers=tuple(float(next(values)) for _ in shape.numbers)))
            for over, shape in self.shapes
        )
        return replace(self, shapes=shapes)

    def column(self, at: Along) -> Floats:
        """Force (s, 1) along the recording for a size of 1."""
        return evaluated(self.factors, self.numbers, **at._asdict())[:, None]


def _named(text: str, names: dict[str, str]) -> str:
    """A shape with its variable and numbers by their names in the formula."""
    tree = ast.parse(text, mode="eval").body
    is_sum = isinstance(tree, ast.BinOp) and isinstance(tree.op, ast.Add | ast.Sub)
    text = f"({text})" if is_sum else text
    return re.sub(r"\b[a-z]+\b", lambda word: names.get(word[0], word[0]), text)
