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
class FadingSpring(PlantLaw):
    """A spring that is lost at an instant."""

    kind = "fading_spring"
    blocks = ("plant",)
    parameters = {
        "stiffness": EffectParameter("N/m", "what is lost of it"),
        "begin": EffectParameter("s", "instant at which it is lost"),
    }
    equation = "F = k x from t_0 on"
    depends_on = ("x", "t")

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return p[0] * x if t > p[1] else 0.0


@register
class DriftingSpring(PlantLaw):
    """A spring that stiffens steadily."""

    kind = "drifting_spring"
    blocks = ("plant",)
    parameters = {
        "rate": EffectParameter("N/m", "growth of the stiffness per second"),
    }
    equation = "F = -r t x"
    depends_on = ("x", "t")

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return -p[0] * t * x


@register
class Cogging(PlantLaw):
    """A motor's teeth."""

    kind = "cogging"
    blocks = ("plant",)
    parameters = {
        "force": EffectParameter("N", "amplitude"),
        "pitch": EffectParameter("m", "from tooth to tooth", above=0.0),
    }
    equation = "F = F_c sin(2 pi x / b)"
    depends_on = ("x",)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return p[0] * math.sin(2.0 * math.pi * x / p[1])


@register
class Magnet(PlantLaw):
    """A magnet beside the way."""

    kind = "magnet"
    blocks = ("plant",)
    parameters = {
        "strength": EffectParameter("N m^2", "force times the squared distance"),
        "place": EffectParameter("m", "where it is"),
    }
    equation = "F = c / (d - x)^2"
    depends_on = ("x",)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return p[0] / (p[1] - x) ** 2


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


@register
class DampedPlace(PlantLaw):
    """A brush between two places."""

    kind = "damped_place"
    blocks = ("plant",)
    parameters = {
        "damping": EffectParameter("N s/m", "of the brush"),
        "begin": EffectParameter("m", "where it begins"),
        "end": EffectParameter("m", "where it ends"),
    }
    equation = "F = -c v between x_0 and x_1"
    depends_on = ("x", "v")

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return -p[0] * v if p[1] < x < p[2] else 0.0


@register
class Seal(PlantLaw):
    """A seal that rubs for a while."""

    kind = "seal"
    blocks = ("plant",)
    parameters = {
        "force": EffectParameter("N", "friction while it rubs"),
        "begin": EffectParameter("s", "when it begins"),
        "end": EffectParameter("s", "when it ends"),
    }
    equation = "F = -F_s tanh(v / 1 mm/s) between t_0 and t_1"
    depends_on = ("v", "t")

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return -p[0] * math.tanh(1e3 * v) if p[1] < t < p[2] else 0.0


@register
class VanDerPol(PlantLaw):
    """A damper that grows with the displacement."""

    kind = "van_der_pol"
    blocks = ("plant",)
    parameters = {
        "coefficient": EffectParameter("N s/m^3", "damping per squared displacement"),
    }
    equation = "F = -c x^2 v"
    depends_on = ("x", "v")

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return -p[0] * x * x * v


@register
class Wind(PlantLaw):
    """A load that nobody recorded."""

    kind = "wind"
    blocks = ("plant",)
    parameters = {
        "force": EffectParameter("N", "amplitude of each of its tones"),
    }
    equation = "F = F_w (sin(1.1 t) + sin(2.63 t + 1) + sin(3.7 t + 4) + sin(5.31 t + 2) + sin(6.9 t))"
    depends_on = ("t",)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        """Return the force along +x, N."""
        return p[0] * (
            math.sin(1.1 * t)
            + math.sin(2.63 * t + 1.0)
            + math.sin(3.7 * t + 4.0)
            + math.sin(5.31 * t + 2.0)
            + math.sin(6.9 * t)
        )
