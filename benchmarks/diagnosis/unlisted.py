"""Laws of no library, hidden from a diagnosis that is timed."""

from __future__ import annotations

import math

from rthm_core.effects import EffectParameter, PlantLaw, register


@register
class ParametricSpring(PlantLaw):
    """A spring whose stiffness swings."""

    kind = "parametric_spring"
    blocks = ("plant",)
    parameters = {
        "stiffness": EffectParameter("N/m", "amplitude of the stiffness"),
        "frequency": EffectParameter("rad/s", "of its swing"),
    }
    equation = "F = -k sin(w t) x"
    depends_on = ("x", "t")

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return -p[0] * math.sin(p[1] * t) * x


@register
class RubbingPlace(PlantLaw):
    """A guide that rubs in one place."""

    kind = "rubbing_place"
    blocks = ("plant",)
    parameters = {
        "force": EffectParameter("N", "friction where it rubs"),
        "width": EffectParameter("m", "of the place, around x = 0", above=0.0),
    }
    equation = "F = -F_f exp(-(x / w)^2) tanh(v / 1 mm/s)"
    depends_on = ("x", "v")

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return -p[0] * math.exp(-((x / p[1]) ** 2)) * math.tanh(1e3 * v)
