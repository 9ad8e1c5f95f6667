"""Springs that are not linear, and drag: forces that follow from position and velocity alone."""

from __future__ import annotations

from rthm_core.effects.base import EffectParameter, register
from rthm_core.effects.laws import PlantLaw


@register
class CubicStiffness(PlantLaw):
    """Spring that stiffens (or softens) with the cube of the displacement."""

    kind = "cubic_stiffness"
    blocks = ("plant",)
    parameters = {
        "coefficient": EffectParameter("N/m^3", "force per cubed displacement; negative: softening")
    }
    equation = "F = -k x^3"
    depends_on = ("x",)
    words = (
        "the spring at {dof} is not linear: its force grows with the cube of the displacement, "
        "by {coefficient}"
    )

    @staticmethod
    def force(x, v, z, t, p, piece):  # type: ignore[no-untyped-def]
        return -p[0] * x * x * x


@register
class QuadraticStiffness(PlantLaw):
    """Spring that is stiffer on one side than on the other."""

    kind = "quadratic_stiffness"
    blocks = ("plant",)
    parameters = {
        "coefficient": EffectParameter("N/m^2", "force per squared displacement, towards -x when positive")
    }
    equation = "F = -k x^2"
    depends_on = ("x",)
    words = (
        "the spring at {dof} is not symmetric: its force grows with the square of the displacement, "
        "by {coefficient}"
    )

    @staticmethod
    def force(x, v, z, t, p, piece):  # type: ignore[no-untyped-def]
        return -p[0] * x * x


@register
class QuadraticDrag(PlantLaw):
    """Drag of a body in a fluid: grows with the square of the speed."""

    kind = "quadratic_drag"
    blocks = ("plant",)
    parameters = {"coefficient": EffectParameter("N s^2/m^2", "drag force per squared speed", minimum=0.0)}
    equation = "F = -c |v| v"
    depends_on = ("v",)
    words = "a drag that grows with the square of the speed acts on {dof}: {coefficient}"
    split = "velocity"

    @staticmethod
    def force(x, v, z, t, p, piece):  # type: ignore[no-untyped-def]
        return -p[0] * piece * v * v
