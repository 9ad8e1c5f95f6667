"""Laws that a spec writes down as a formula: a force on a dof, a force of a wire, an error of a motor."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, ClassVar, cast

from rthm_core.effects.declaration import Effect
from rthm_core.effects.formula import FormulaNumber, FormulaText, Names, Parsed, parsed, python_of
from rthm_core.effects.laws import LOAD, PlantLaw, WireLaw
from rthm_core.effects.motor import MotorEffect
from rthm_core.effects.registry import register
from rthm_core.errors import RefusedError

Function = Callable[..., float]

Functions = Mapping[str, tuple[str, str]]
"""Functions of a law by name: their arguments, and what they return."""

NOUN = "a force given by a formula"
SEEN = "Repeat the test at another amplitude: outside the range that was seen, a formula is a guess."
BESIDE = "with numbers a to g that stand beside it"

ARGUMENTS = "x, v, z, t, p, mode"
"""Of the functions of a law on the plant."""


class Written(Effect):
    """What has a formula in the spec.

    Attributes
    ----------
    text
        The parameter that is the formula.
    function
        The function that it becomes, its arguments, and what it returns for the formula.
    names
        What of the formula has another name there.

    Where one formula becomes several functions, `functions` says which.
    """

    kind = "formula"
    written = True
    equation = "F = what the spec says"
    noun = NOUN
    experiment = SEEN
    text: ClassVar[str] = "force"
    function: ClassVar[tuple[str, str, str]]
    names: ClassVar[Names] = {}

    @classmethod
    def given(cls, values: Mapping[str, Any]) -> type[Effect]:
        """The law of a formula, with its numbers as parameters; this class where there is none.

        Raises
        ------
        RefusedError
            If the text is no formula.
        """
        text = values.get(cls.text)
        try:
            return cls.of(text) if isinstance(text, str) else cls
        except RefusedError as refused:
            raise RefusedError(text, refused.allowed, refused.way_out, cls.text) from None

    @classmethod
    def variables(cls) -> tuple[str, ...]:
        """What its formula may depend on."""
        return cast("FormulaText", cls.parameters[cls.text]).variables

    @classmethod
    def of(cls, text: str) -> type[Effect]:
        """The law that computes a formula.

        Raises
        ------
        RefusedError
            If it is none.
        """
        base: Any = cls
        return _law(base, text)

    @classmethod
    def functions(cls, found: Parsed) -> Functions:
        """What a formula becomes; by default `function`."""
        name, arguments, returned = cls.function
        return {name: (arguments, returned.format(python_of(found, cls.names)))}

    @classmethod
    def declared(cls, found: Parsed) -> dict[str, Any]:
        """What a law of a formula declares beside its functions and parameters."""
        return {}


@cache
def _law(base: Any, text: str) -> type[Effect]:
    found = parsed(text, base.variables())
    scope: dict[str, object] = {"math": math}
    functions = base.functions(found)
    for name, (arguments, value) in functions.items():
        exec(f"def {name}({arguments}):\n    return float({value})", scope)
    numbers = {one: FormulaNumber("1", "number of the formula, in SI units") for one in found.numbers}
    body = {name: staticmethod(cast("Function", scope[name])) for name in functions} | {
        "parameters": base.parameters | numbers,
        "given": classmethod(lambda cls, values: cls),
    }
    return type(f"{base.__name__}Law", (base,), body | base.declared(found))


def _is_kinked(found: Parsed) -> bool:
    return any(isinstance(node, ast.Compare) for node in ast.walk(found.tree))


@register
class Formula(Written, PlantLaw):
    """A force that is written in the spec as a formula; between two dofs, of how they move apart."""

    blocks = ("plant",)
    between_dofs = True
    parameters = {
        "force": FormulaText(
            "force along +x, N, of x (m), v (m/s), t (s) and load (N, the known load on the dof), "
            f"{BESIDE}, as -a * x * abs(x)",
            variables=("x", "v", "t", "load"),
        )
    }
    words = "the force {force} acts on {dof}"
    function = ("force", ARGUMENTS, "{}")
    names = {"load": f"p[{LOAD}]", "sign(v)": "mode"}

    @classmethod
    def declared(cls, found: Parsed) -> dict[str, Any]:
        """On what it depends, and where it has modes and kinks."""
        turns = any(ast.unparse(node) == "sign(v)" for node in ast.walk(found.tree))
        return {
            "depends_on": found.variables,
            "additive": not {"x", "v"} & {*found.variables},
            "partition": "velocity" if turns else "none",
            "kinked": _is_kinked(found),
        }


@register
class WireFormula(Written, WireLaw):
    """A force that a wire has beside that of its spring, written in the spec as a formula."""

    blocks = ("wire",)
    parameters = {
        "force": FormulaText(
            f"force beside k elongation, N, of the elongation u - x (m), {BESIDE}, as a * elongation**3",
            variables=("elongation",),
        )
    }
    equation = "F = k (u - x) + what the spec says"
    depends_on = ("x", "u")
    words = "the wire of {actuator} has the force {force} beside that of its spring"
    function = ("force", "u, x, v, k, f, z, p", "f + {}")
    names = {"elongation": "(u - x)"}
    order = 3

    @classmethod
    def declared(cls, found: Parsed) -> dict[str, Any]:
        """Its force, and whether that has kinks."""
        return {"kinked": _is_kinked(found)}


@register
class MotorFormula(Written, MotorEffect):
    """A position by which a drive misses its command, written in the spec as a formula."""

    blocks = ("motor",)
    parameters = {
        "shift": FormulaText(
            f"position that the drive adds to its command u (m) when it takes it at t (s), m, {BESIDE}, "
            "as a * sin(2 * pi * u / b)",
            variables=("u", "t"),
        )
    }
    equation = "u = u_d + what the spec says"
    words = "the motor of {actuator} goes to its command and {shift}"
    noun = "an error of the motor given by a formula"
    experiment = "Move the motor slowly over its whole way with the dof free, and measure where it is."
    changes = "command"
    text = "shift"
    function = ("shift", "u, t, p", "{}")
    harmless, gross = 0.0, 0.0

    @classmethod
    def declared(cls, found: Parsed) -> dict[str, Any]:
        """On what it depends."""
        return {"depends_on": tuple("command" if name == "u" else name for name in found.variables)}
