"""Formulas that a spec may have: what they may say, and what they compute.

A formula is arithmetic and nothing else, so a spec from anywhere may have one: it can compute a number, and
do nothing besides.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Mapping
from copy import deepcopy
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.errors import RefusedError
from rthm_core.quantity import Quantity, Text

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

Names = Mapping[str, str]
"""What of a formula has another name in Python."""

NUMBERS = ("a", "b", "c", "d", "e", "f", "g")
"""Names of the numbers of a formula, in the order in which compiled code gets them."""

FUNCTIONS = {
    "abs": "abs", "min": "min", "max": "max", "sign": "sign",
    **{name: f"math.{name}" for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "tanh", "atan")},
}  # fmt: skip
"""Functions of a formula, and what they are in Python."""

ALONG = {"abs": "abs", "sign": "sign", "atan": "arctan"} | {
    name: name for name in ("sqrt", "exp", "log", "sin", "cos", "tan", "tanh")
}
"""Those of one number for arrays, in numpy."""

_ARITHMETIC = (
    ast.Expression, ast.BinOp, ast.UnaryOp, ast.Compare, ast.Call, ast.Name, ast.Load, ast.Constant, ast.Add,
    ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.USub, ast.UAdd, ast.Lt, ast.Gt,
)  # fmt: skip


def allowed(variables: Iterable[str]) -> str:
    """What a formula of some variables may be, in words."""
    return (
        f"a formula of {', '.join(variables)}, numbers {NUMBERS[0]} to {NUMBERS[-1]}, pi, + - * / **, "
        f"comparisons with < and > (1 where true, else 0) and {', '.join(FUNCTIONS)}"
    )


class Parsed(NamedTuple):
    """A formula taken apart.

    Attributes
    ----------
    tree
        Its syntax.
    variables, numbers
        Names in it, in the order of what it may depend on, and of `NUMBERS`.
    """

    tree: ast.Expression
    variables: tuple[str, ...]
    numbers: tuple[str, ...]


@lru_cache(maxsize=256)
def parsed(text: str, may: tuple[str, ...]) -> Parsed:
    """Take a formula apart.

    Parameters
    ----------
    text
    may
        Variables on which it may depend.

    Raises
    ------
    RefusedError
        If it is anything but arithmetic of these and of numbers.

    Examples
    --------
    >>> parsed("-a * sin(2 * pi * x / b)", ("x", "v")).numbers
    ('a', 'b')
    """
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise RefusedError(text, allowed(may)) from None
    functions = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
    names = set()
    for node in ast.walk(tree):
        if not isinstance(node, _ARITHMETIC) or not _is_plain(node):
            raise RefusedError(text, allowed(may))
        if isinstance(node, ast.Name):
            if node.id not in (FUNCTIONS if id(node) in functions else {*may, *NUMBERS, "pi"}):
                raise RefusedError(text, allowed(may), f"{node.id} is unknown")
            names.add(node.id)
    variables = tuple(name for name in may if name in names)
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
    """An entry that is a formula of some variables."""

    longest: int = 400
    variables: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:  # type: ignore[override]
        """What it may be, in words."""
        return allowed(self.variables)

    def convert(self, value: object) -> str:
        """Return `value` if it is a formula; else raise RefusedError."""
        text = super().convert(value)
        parsed(text, self.variables)
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
    """Makes Python of a formula: numbers become elements of `p`, what is known by another name that."""

    def __init__(self, numbers: tuple[str, ...], names: Names) -> None:
        self._names = {name: f"p[{i}]" for i, name in enumerate(numbers)} | FUNCTIONS
        self._names |= {"pi": "math.pi"} | dict(names)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Replace a function."""
        if (known := self._names.get(ast.unparse(node))) is not None:
            return _expression(known)
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


def python_of(found: Parsed, names: Names) -> str:
    """A formula as an expression of its variables and the array p of its numbers.

    Parameters
    ----------
    found
    names
        What has another name in Python: variables, and the sign of the velocity.

    Examples
    --------
    >>> python_of(parsed("-a * sign(v) * (b < x)", ("x", "v")), {"sign(v)": "mode"})
    '-p[0] * mode * (1.0 * (p[1] < x))'
    """
    return ast.unparse(_Python(found.numbers, names).visit(deepcopy(found.tree)))


class _Without(ast.NodeTransformer):
    """Leaves out a number where it is added to something, or taken from it."""

    def __init__(self, number: str) -> None:
        self._number = number

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """Keep the other side of a sum."""
        self.generic_visit(node)
        if isinstance(node.op, ast.Add | ast.Sub):
            if self._is_it(node.right):
                return node.left
            if self._is_it(node.left):
                return node.right if isinstance(node.op, ast.Add) else ast.UnaryOp(ast.USub(), node.right)
        return node

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Leave out a bound at zero of what is never below it: time, and a size."""
        self.generic_visit(node)
        first = node.args[0]
        is_bound = ast.unparse(node) == f"max({ast.unparse(first)}, 0)"
        size = isinstance(first, ast.Call) and ast.unparse(first.func) == "abs"
        return first if is_bound and (size or ast.unparse(first) == "t") else node

    def _is_it(self, node: ast.AST) -> bool:
        return isinstance(node, ast.Name) and node.id == self._number


def without(text: str, number: str) -> str | None:
    """A formula in which a number is zero that is only added to something; None where it is anything else.

    Examples
    --------
    >>> without("a * exp(-((x - b) / c)**2)", "b")
    'a * exp(-(x / c)**2)'
    >>> without("a * x * max(t - b, 0)", "b")
    'a * x * t'
    >>> without("a * sin(b * x)", "b") is None
    True
    """
    tree = _Without(number).visit(ast.parse(text.strip(), mode="eval"))
    left = any(isinstance(node, ast.Name) and node.id == number for node in ast.walk(tree))
    return None if left else ast.unparse(tree).replace(" ** ", "**")


class _WithoutCompared(ast.NodeTransformer):
    """Leaves out factors in which a number is compared with something."""

    def __init__(self, number: str) -> None:
        self._number = number

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        """Keep the other factor of a product."""
        self.generic_visit(node)
        if isinstance(node.op, ast.Mult):
            if self._compares(node.right):
                return node.left
            if self._compares(node.left):
                return node.right
        return node

    def _compares(self, node: ast.AST) -> bool:
        if not isinstance(node, ast.Compare):
            return False
        return self._number in (ast.unparse(node.left), *map(ast.unparse, node.comparators))


def compared_with(text: str) -> dict[str, str]:
    """Numbers of a formula that are compared with a variable by themselves, and these variables.

    Examples
    --------
    >>> compared_with("a * x * (b < t) * (v < c)")
    {'b': 't', 'c': 'v'}
    """
    found = {}
    for node in ast.walk(ast.parse(text.strip(), mode="eval")):
        if isinstance(node, ast.Compare):
            sides = ast.unparse(node.left), ast.unparse(node.comparators[0])
            number, variable = sides if sides[0] in NUMBERS else sides[::-1]
            if number in NUMBERS and variable.isidentifier() and variable not in NUMBERS:
                found[number] = variable
    return dict(sorted(found.items()))


def without_compared(text: str, number: str) -> str:
    """A formula without the factors in which a number is compared with something, as if they were true.

    Examples
    --------
    >>> without_compared("a * x * (b < t) * (t < c)", "b")
    'a * x * (t < c)'
    """
    tree = _WithoutCompared(number).visit(ast.parse(text.strip(), mode="eval"))
    return ast.unparse(tree).replace(" ** ", "**")


_SCOPE: dict[str, Any] = {name: getattr(np, function) for name, function in ALONG.items()}
_SCOPE |= {"min": lambda *some: reduce(np.minimum, some), "max": lambda *some: reduce(np.maximum, some)}
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
