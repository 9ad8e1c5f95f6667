"""Force that remembers where the motion last turned."""

from __future__ import annotations

from rthm_core.effects.base import EffectParameter, register
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import Plainer, Possible, Seen, Values, between

BOUC_WEN_PARAMETERS = {
    "alpha": EffectParameter(
        "N/m", "force per hysteretic state; the slope near zero is alpha A", minimum=0.0
    ),
    "A": EffectParameter("1", "initial slope of the state; 1 by convention", minimum=0.0, default=1.0),
    "beta": EffectParameter("1/m^n", "width of the loop"),
    "gamma": EffectParameter("1/m^n", "shape of the loop"),
    "n": EffectParameter("1", "sharpness of the yield", minimum=1.0, maximum=20.0, default=1.0),
}

NARROWEST = 2.0
"""Largest gamma over beta, either way: beyond, a loop is a bent spring."""

SHARPEST = 5.0
"""Largest exponent: from there on the yield is a corner."""


def _shaped(p: Values, seen: Seen) -> tuple[float, float]:
    """Shapes of a loop that is as wide as beta says."""
    return -NARROWEST * abs(p["beta"]), NARROWEST * abs(p["beta"])


def yield_force(p: Values) -> float:
    """Largest force of a loop, N; of one that stiffens, where it would yield without gamma."""
    total = p["beta"] + p["gamma"]
    total = total if total > 0.0 else p["beta"]
    return float(p["alpha"] * (p["A"] / max(total, 1e-300)) ** (1.0 / p["n"]))


BOUC_WEN_POSSIBLE: dict[str, Possible] = {
    "beta": between(1e-12),  # only then does every loop take energy out, whatever gamma is
    "gamma": _shaped,
    "n": between(1.0, SHARPEST),
}

BOUC_WEN_SECONDARY = ("A", "gamma")


@register
class BoucWen(PlantLaw):
    """Hysteretic spring of Bouc and Wen."""

    kind = "bouc_wen"
    flexible = True
    blocks = ("plant",)
    parameters = BOUC_WEN_PARAMETERS
    equation = "F = -alpha z; dz/dt = A v - beta |v| |z|^(n-1) z - gamma v |z|^n"
    depends_on = ("x", "v")
    words = (
        "the spring at {dof} is hysteretic (Bouc-Wen): its force depends on where the motion last turned; "
        "in small motions it adds a stiffness of {alpha}"
    )
    possible = BOUC_WEN_POSSIBLE
    secondary = BOUC_WEN_SECONDARY
    plainer = (Plainer("coulomb_friction", lambda p: {"force": yield_force(p)}),)
    states = 1
    split = "velocity"

    @staticmethod
    def force(x, v, z, t, p, piece):  # type: ignore[no-untyped-def]
        return -p[0] * z[0]

    @staticmethod
    def rate(x, v, z, t, p, piece, dz):  # type: ignore[no-untyped-def]
        size = abs(z[0]) ** (p[4] - 1.0) if p[4] != 1.0 else 1.0
        dz[0] = v * (p[1] - size * (p[2] * piece * z[0] + p[3] * abs(z[0])))

    @staticmethod
    def initial(x, p):  # type: ignore[no-untyped-def]
        return (0.0,)
