"""A law that a spec writes down: a force as a formula of motion, time and the known load.

A formula is arithmetic and nothing else, so a spec from anywhere may have one: it can compute a number, and
do nothing besides.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from rthm_core.effects.declaration import Effect
from rthm_core.effects.laws import LOAD, PlantLaw
from rthm_core.effects.registry import register
from rthm_core.errors import RefusedError
from rthm_core.quantity import Quantity, Text

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

VARIABLES = {"x": "m", "v": "m/s", "t": "s", "load": "N"}
"""What a formula may depend on, and the units."""

NUMBERS = ("a", "b", "c", "d", "e", "f", "g")
"""Names of the numbers of a formula, in the order in which compiled code gets them."""

FUNCTIONS = {
    "abs": "abs", "min": "min", "max": "max", "sign": "sign",
    **{name: f"math.{name}" for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "tanh", "atan")},
}  # fmt: skip
"""Functions of a formula, and what they are in Python."""

ALONG = {"abs": "abs", "min": "minimum", "max": "maximum", "sign": "sign", "atan": "arctan"} | {
    name: name for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "tanh")
}
"""The same for arrays, in numpy."""

_ARITHMETIC = (
    ast.Expression, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Call, ast.Name, ast.Load, ast.Constant, ast.Add,
    ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.USub, ast.UAdd, ast.Lt, ast.Gt,
)  # fmt: skip
_ALLOWED = (
    f"a formula of {', '.join(VARIABLES)}, numbers {NUMBERS[0]} to {NUMBERS[-1]}, pi, + - * / **, "
    f"comparisons with < and > (1 where true, else 0) and {', '.join(FUNCTIONS)}"
)


class Parsed(NamedTuple):
    """A formula taken apart.

    Attributes
    ----------
    tree
        Its syntax.
    variables, numbers
        Names in it, in the order of `VARIABLES` and `NUMBERS`.
    """

    tree: ast.Expression
    variables: tuple[str, ...]
    numbers: tuple[str, ...]


@lru_cache(maxsize=256)
def parsed(text: str) -> Parsed:
    """Take a formula apart.

    Raises
    ------
    RefusedError
        If it is anything but arithmetic of motion, time, load and numbers.

    Examples
    --------
    >>> parsed("-a * sin(2 * pi * x / b)").numbers
    ('a', 'b')
    """
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise RefusedError(text, _ALLOWED) from None
    functions = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    names = set()
    for node in ast.walk(tree):
        if not isinstance(node, _ARITHMETIC) or not _is_plain(node):
            raise RefusedError(text, _ALLOWED)
        if isinstance(node, ast.Name):
            if node.id not in (FUNCTIONS if id(node) in functions else {*VARIABLES, *NUMBERS, "pi"}):
                raise RefusedError(text, _ALLOWED, f"{node.id} is unknown")
            names.add(node.id)
    variables = tuple(name for name in VARIABLES if name in names)
    return Parsed(tree, variables, tuple(name for name in NUMBERS if name in names))


def _is_plain(node: ast.AST) -> bool:
    """Whether a node is no text, compares two, and calls a function by its name alone."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.Compare):
        return len(node.ops) == 1
    return not isinstance(node, ast.Call) or (isinstance(node.func, ast.Name) and not node.keywords)


@dataclass(frozen=True)
class FormulaText(Text):
    """An entry that is a formula."""

    allowed = _ALLOWED

    def convert(self, value: object) -> str:
        """Return `value` if it is a formula; else raise RefusedError."""
        text = super().convert(value)
        parsed(text)
        return text


@dataclass(frozen=True)
class FormulaNumber(Quantity):
    """A number of a formula, in whatever unit the formula makes of it: of any size."""

    @property
    def largest(self) -> float:
        """Largest size."""
        return math.inf


class _Along(ast.NodeTransformer):
    """Makes numbers of comparisons: arrays of truths have no arithmetic."""

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        """Count a truth as 1."""
        self.generic_visit(node)
        return ast.BinOp(ast.Constant(1.0), ast.Mult(), node)


class _Python(_Along):
    """Makes Python of a formula: numbers become elements of `p`, the sign of the velocity the mode."""

    def __init__(self, numbers: tuple[str, ...]) -> None:
        self._names = {name: f"p[{i}]" for i, name in enumerate(numbers)} | FUNCTIONS
        self._names |= {"pi": "math.pi", "load": f"p[{LOAD}]"}

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Replace a function."""
        if ast.unparse(node) == "sign(v)":
            return _expression("mode")
        self.generic_visit(node)
        if ast.unparse(node.func) == "sign":
            return _expression(f"math.copysign(1.0, {ast.unparse(node.args[0])})")
        return node

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        """Make a number real: powers of whole numbers may have no end of digits."""
        return ast.Constant(float(node.value))  # type: ignore[arg-type]

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """Keep a whole exponent, with which a power is products."""
        whole = isinstance(node.op, ast.Pow) and isinstance(node.right, ast.Constant)
        exponent = node.right
        self.generic_visit(node)
        if whole and isinstance(exponent, ast.Constant) and isinstance(exponent.value, int):
            node.right = exponent
        return node

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Replace a name."""
        return _expression(self._names.get(node.id, node.id))


def _expression(text: str) -> ast.AST:
    return ast.parse(text, mode="eval").body


def python_of(text: str) -> str:
    """The formula as an expression of x, v, t, p and mode.

    Examples
    --------
    >>> python_of("-a * sign(v) * (b < x)")
    '-p[0] * mode * (1.0 * (p[1] < x))'
    """
    found = parsed(text)
    tree = _Python(found.numbers).visit(ast.parse(text.strip(), mode="eval"))
    return ast.unparse(tree)


_SCOPE: dict[str, Any] = {name: getattr(np, function) for name, function in ALONG.items()}
_SCOPE |= {"pi": math.pi, "__builtins__": {}}


def evaluated(text: str, numbers: Mapping[str, float], **variables: Floats) -> Floats:
    """A formula along arrays of its variables; infinite or no number where Python would fail.

    Parameters
    ----------
    text
        Of more variables than a law may have, if they are given.
    numbers
        Values of its numbers.
    **variables
        Arrays of one shape.

    Examples
    --------
    >>> evaluated("a * x * (b < x)", {"a": 2.0, "b": 1.0}, x=np.array([1.0, 3.0]))
    array([0., 6.])
    """
    scope: dict[str, Any] = _SCOPE | dict(numbers) | variables
    with np.errstate(all="ignore"):
        found = np.asarray(eval(_code(text), scope), dtype=float)
    return np.broadcast_to(found, next(iter(variables.values())).shape)


@lru_cache(maxsize=1024)
def _code(text: str) -> Any:
    tree = _Along().visit(ast.parse(text.strip(), mode="eval"))
    return compile(ast.fix_missing_locations(tree), "<formula>", "eval")


@register
class Formula(PlantLaw):
    """A force that is written in the spec as a formula."""

    kind = "formula"
    blocks = ("plant",)
    parameters = {
        "force": FormulaText(
            "force along +x, N, of x (m), v (m/s), t (s) and load (N, the known load on the dof), with "
            "numbers a to g that stand beside it, as -a * x * abs(x)"
        )
    }
    equation = "F = what the spec says"
    words = "the force {force} acts on {dof}"
    noun = "a force given by a formula"
    experiment = (
        "Repeat the test at another amplitude: outside the range that was seen, a formula is a guess."
    )
    written = True

    @classmethod
    def given(cls, values: Mapping[str, Any]) -> type[Effect]:
        """The law of a formula, with its numbers as parameters; this class where there is none.

        Raises
        ------
        RefusedError
            If the text is no formula.
        """
        text = values.get("force")
        try:
            return law_of(text) if isinstance(text, str) else cls
        except RefusedError as refused:
            raise RefusedError(text, refused.allowed, refused.way_out, "force") from None


@lru_cache(maxsize=256)
def law_of(text: str) -> type[Formula]:
    """Law that computes a formula.

    Raises
    ------
    RefusedError
        If it is none.
    """
    found = parsed(text)
    scope: dict[str, object] = {"math": math}
    source = python_of(text)
    exec(f"def force(x, v, z, t, p, mode):\n    return float({source})", scope)
    declared = {name: FormulaNumber("1", "number of the formula, in SI units") for name in found.numbers}
    body = {
        "force": staticmethod(cast("Callable[..., float]", scope["force"])),
        "parameters": Formula.parameters | declared,
        "depends_on": found.variables,
        "additive": not {"x", "v"} & {*found.variables},
        "partition": "velocity" if "mode" in source else "none",
        "kinked": any(isinstance(node, ast.Compare) for node in ast.walk(found.tree)),
        "given": classmethod(lambda cls, values: cls),
    }
    return type("WrittenFormula", (Formula,), body)
