"""Mass that depends on where a dof is, written in the spec as a formula: a crank, a lever, a pendulum."""

from __future__ import annotations

from typing import Any

from rthm_core.effects.derivative import derivative, jumps
from rthm_core.effects.formula import FormulaText, Names, Parsed, allowed, python_of
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.registry import register
from rthm_core.effects.written import ARGUMENTS, BESIDE, Functions, Written
from rthm_core.errors import RefusedError


@register
class Inertia(Written, PlantLaw):
    """Mass that moves with a dof beside the plant's own, and depends on where the dof is.

    The formula is that of the mass alone. By Lagrange the kinetic energy ``m(x) v^2 / 2`` makes the rest:
    ``d/dt (m v) - m' v^2 / 2 = m a + m' v^2 / 2``.
    """

    kind = "inertia"
    blocks = ("plant",)
    parameters = {
        "mass": FormulaText(
            "mass that moves with the dof beside the plant's own, kg (kg m^2 where it turns), of x (m), "
            f"{BESIDE}, as a * (1 + b * cos(x))",
            variables=("x",),
        )
    }
    equation = "F = -m(x) a - m'(x) v^2 / 2"
    words = "the mass {mass} moves with {dof}"
    noun = "a mass given by a formula"
    depends_on = ("x", "v", "a")
    text = "mass"

    @classmethod
    def functions(cls, found: Parsed) -> Functions:
        """The mass, and the force that its change along the way makes.

        Raises
        ------
        RefusedError
            If the mass jumps: its energy would.
        """
        if jumps(found):
            allowed_here = f"{allowed(cls.variables())}, without comparisons and sign"
            way_out = "a mass that jumps with the position has no energy that is kept"
            raise RefusedError(cls.text, allowed_here, way_out)
        names: Names = {}
        mass, slope = python_of(found, names), python_of(derivative(found, "x"), names)
        return {"inertia": (ARGUMENTS, mass), "force": (ARGUMENTS, f"-0.5 * v * v * ({slope})")}

    @classmethod
    def declared(cls, found: Parsed) -> dict[str, Any]:
        """Whether it depends on the position."""
        return {"depends_on": cls.depends_on if found.variables else ("a",)}
