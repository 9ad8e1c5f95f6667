"""Masses that depend on where dofs are, written in the spec as a formula: a crank, a lever, a pendulum."""

from __future__ import annotations

from typing import Any

from rthm_core.effects.derivative import derivative, jumps
from rthm_core.effects.formula import FormulaText, Parsed, allowed, python_of
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.registry import register
from rthm_core.effects.written import ARGUMENTS, BESIDE, Functions, Written
from rthm_core.errors import RefusedError


class MassFormula(Written, PlantLaw):
    """What has a formula of a mass, from which all its forces follow by Lagrange."""

    blocks = ("plant",)
    depends_on = ("x", "v", "a")
    text = "mass"

    @classmethod
    def declared(cls, found: Parsed) -> dict[str, Any]:
        """Whether it depends on the position."""
        return {"depends_on": cls.depends_on if found.variables else ("a",)}

    @classmethod
    def expressions(cls, found: Parsed) -> list[str]:
        """The mass, and its slopes over all that it may depend on, in Python.

        Raises
        ------
        RefusedError
            If the mass jumps: its energy would.
        """
        if jumps(found):
            allowed_here = f"{allowed(cls.variables())}, without comparisons and sign"
            way_out = "a mass that jumps with the position has no energy that is kept"
            raise RefusedError(cls.text, allowed_here, way_out)
        slopes = [derivative(found, variable) for variable in cls.variables()]
        return [python_of(one, {}) for one in (found, *slopes)]


@register
class Inertia(MassFormula):
    """Mass that moves with a dof beside the plant's own, and depends on where the dof is.

    The formula is that of the mass alone. By Lagrange the kinetic energy ``m(x) v^2 / 2`` makes the rest:
    ``d/dt (m v) - m' v^2 / 2 = m a + m' v^2 / 2``.
    """

    kind = "inertia"
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

    @classmethod
    def functions(cls, found: Parsed) -> Functions:
        """The mass, and the force that its change along the way makes."""
        mass, slope = cls.expressions(found)
        return {"inertia": (ARGUMENTS, mass), "force": (ARGUMENTS, f"-0.5 * v * v * ({slope})")}


@register
class InertialCoupling(MassFormula):
    """Mass that couples the accelerations of two dofs, and depends on where both are: the entry of the mass
    matrix that they share.

    By Lagrange the kinetic energy ``m(x, y) v w`` makes a force on each: ``d/dt (m w) - dm/dx v w`` is
    ``m a_y + dm/dy w^2``, and likewise for the other.
    """

    kind = "inertial_coupling"
    parameters = {
        "mass": FormulaText(
            "mass that couples dof and relative_to, kg (kg m where one of them turns, kg m^2 where both do), "
            f"of their positions x and y (m), {BESIDE}, as a * cos(x - y)",
            variables=("x", "y"),
        )
    }
    equation = "F = -m(x, y) a_y - dm/dy w^2 on dof, -m(x, y) a_x - dm/dx v^2 on relative_to"
    words = "the mass {mass} couples the accelerations of {dof}"
    noun = "a mass that couples two dofs, given by a formula"

    @classmethod
    def functions(cls, found: Parsed) -> Functions:
        """The mass and its slopes, from which both forces are made; there is no other."""
        names = ("coupling", "coupling_by_x", "coupling_by_y")
        return {name: ("x, y, p", one) for name, one in zip(names, cls.expressions(found), strict=True)} | {
            "force": (ARGUMENTS, "0.0")
        }
