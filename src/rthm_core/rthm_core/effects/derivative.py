"""Derivatives of formulas: formulas themselves, of the same variables and numbers."""

from __future__ import annotations

import ast

from rthm_core.effects.formula import Parsed

INNER = {
    "sqrt": "0.5 / sqrt(U)", "exp": "exp(U)", "log": "1 / U", "sin": "cos(U)", "cos": "-sin(U)",
    "tan": "1 / cos(U)**2", "tanh": "1 - tanh(U)**2", "atan": "1 / (1 + U**2)", "abs": "sign(U)",
}  # fmt: skip
"""Derivatives of the functions of a formula over their argument U; of min and max there are two."""


def derivative(found: Parsed, variable: str) -> Parsed:
    """Derivative of a formula; where it has a kink, that of one of its sides.

    Parameters
    ----------
    found
        Without comparisons and `sign`: where a formula jumps it has no derivative.
    variable
        Over which.

    Examples
    --------
    >>> from rthm_core.effects.formula import parsed
    >>> ast.unparse(derivative(parsed("a * sin(b * x)", ("x",)), "x").tree)
    'a * (cos(b * x) * b)'
    """
    rate = _of(found.tree.body, variable)
    text = "0" if rate is None else ast.unparse(rate)
    return found._replace(tree=ast.parse(text, mode="eval"))  # of its own: parts occur in it more than once


def jumps(found: Parsed) -> bool:
    """Whether a formula has what is not continuous: a comparison, or a sign."""
    nodes = [*ast.walk(found.tree)]
    return any(isinstance(n, ast.Compare) or (isinstance(n, ast.Name) and n.id == "sign") for n in nodes)


def _of(node: ast.expr, variable: str) -> ast.expr | None:
    """Derivative of an expression; None where it is zero."""
    if isinstance(node, ast.Name):
        return ast.Constant(1) if node.id == variable else None
    if isinstance(node, ast.UnaryOp):
        rate = _of(node.operand, variable)
        return None if rate is None else ast.UnaryOp(node.op, rate)
    if isinstance(node, ast.BinOp):
        return _of_two(node, variable)
    return _of_function(node, variable) if isinstance(node, ast.Call) else None


def _of_two(node: ast.BinOp, variable: str) -> ast.expr | None:
    """Derivative of a sum, a product, a quotient or a power."""
    left, right = _of(node.left, variable), _of(node.right, variable)
    if left is None and right is None:
        return None
    if isinstance(node.op, ast.Add | ast.Sub):
        if left is None or right is None:
            negative = left is None and isinstance(node.op, ast.Sub)
            return _as("-U", U=right) if negative else left or right
        return ast.BinOp(left, node.op, right)
    if isinstance(node.op, ast.Mult):
        return _sum(_product(left, node.right), _product(node.left, right))
    if isinstance(node.op, ast.Div):
        first = None if left is None else _as("U / V", U=left, V=node.right)
        return _sum(first, right and _as("-U * W / V**2", U=node.left, V=node.right, W=right))
    return _of_power(node, left, right)


def _of_power(node: ast.BinOp, left: ast.expr | None, right: ast.expr | None) -> ast.expr | None:
    """Derivative of a power, given those of its base and of its exponent."""
    first = None
    if left is not None:
        power = _as("U - 1", U=node.right)
        if isinstance(node.right, ast.Constant):  # a whole exponent stays one, and a power a product
            power = ast.Constant(node.right.value - 1)  # type: ignore[operator]
        first = _product(_as("V * U**P", V=node.right, U=node.left, P=power), left)
    second = right and _product(_as("P * log(U)", P=node, U=node.left), right)
    return _sum(first, second)


def _of_function(node: ast.Call, variable: str) -> ast.expr | None:
    """Derivative of a function of a formula."""
    name, rates = ast.unparse(node.func), [_of(one, variable) for one in node.args]
    if all(rate is None for rate in rates):
        return None
    if name not in ("min", "max"):
        return _product(_as(INNER[name], U=node.args[0]), rates[0])
    order, found, rate = "<" if name == "min" else ">", node.args[0], rates[0]
    for other, its in zip(node.args[1:], rates[1:], strict=True):
        ahead = _as(f"V {order} U", U=found, V=other)
        rate = _sum(_product(_as("1 - C", C=ahead), rate), _product(ahead, its))
        found = _as(f"{name}(U, V)", U=found, V=other)
    return rate


def _sum(left: ast.expr | None, right: ast.expr | None) -> ast.expr | None:
    if left is None or right is None:
        return left or right
    return ast.BinOp(left, ast.Add(), right)


def _product(left: ast.expr | None, right: ast.expr | None) -> ast.expr | None:
    if left is None or right is None:
        return None
    if isinstance(right, ast.Constant) and right.value == 1:
        return left
    return ast.BinOp(left, ast.Mult(), right)


def _as(text: str, **parts: ast.expr | None) -> ast.expr:
    """An expression with others in the place of its capitals."""
    return _Parts(parts).visit(ast.parse(text, mode="eval").body)  # type: ignore[no-any-return]


class _Parts(ast.NodeTransformer):
    """Puts expressions in the place of names."""

    def __init__(self, parts: dict[str, ast.expr | None]) -> None:
        self._parts = parts

    def visit_Name(self, node: ast.Name) -> ast.AST:
        """Replace a name."""
        return self._parts.get(node.id) or node
