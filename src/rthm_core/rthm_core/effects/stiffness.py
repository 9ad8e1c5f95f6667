"""Springs that are not linear, and drag: forces that follow from position and velocity alone."""

from __future__ import annotations

from collections.abc import Iterator

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals, rms
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.registry import register

STATICALLY = "Pull {place} statically to several displacements on both sides."


@register
class CubicStiffness(PlantLaw):
    """Spring that stiffens (or softens) with the cube of the displacement."""

    kind = "cubic_stiffness"
    between_dofs = True
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
    experiment = STATICALLY
    power = 3
    rank = 40
    common = True

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Linear in its coefficient, of either sign."""
        coefficient = TRIAL_FORCE * signals.size / rms(signals.x**3)
        yield Guess({"coefficient": coefficient}, ("coefficient",), signed=True)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return -p[0] * x * x * x


@register
class QuadraticStiffness(PlantLaw):
    """Spring that is stiffer on one side than on the other."""

    kind = "quadratic_stiffness"
    between_dofs = True
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
    experiment = STATICALLY
    power = 2
    rank = 50

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Linear in its coefficient, of either sign."""
        coefficient = TRIAL_FORCE * signals.size / rms(signals.x**2)
        yield Guess({"coefficient": coefficient}, ("coefficient",), signed=True)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return -p[0] * x * x


@register
class QuadraticDrag(PlantLaw):
    """Drag of a body in a fluid: grows with the square of the speed."""

    kind = "quadratic_drag"
    between_dofs = True
    blocks = ("plant",)
    parameters = {"coefficient": EffectParameter("N s^2/m^2", "drag force per squared speed", minimum=0.0)}
    equation = "F = -c |v| v"
    depends_on = ("v",)
    words = "a drag that grows with the square of the speed acts on {dof}: {coefficient}"
    experiment = "Repeat the test at twice the amplitude."
    partition = "velocity"
    rank = 30
    common = True

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Linear in its coefficient."""
        yield Guess({"coefficient": TRIAL_FORCE * signals.size / rms(signals.v**2)}, ("coefficient",))

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return -p[0] * mode * v * v
