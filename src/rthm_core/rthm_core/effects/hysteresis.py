"""Force that remembers where the motion last turned."""

from __future__ import annotations

from collections.abc import Iterator

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.friction import CoulombFriction
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals, rms
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import Plainer, Possible, Seen, Values, between
from rthm_core.effects.registry import register

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

BOUC_WEN_POWERS = {"beta": "n"}
"""The width of a loop goes with the n-th root of beta."""

BOUC_WEN_ALONG = {"gamma": "beta"}

BOUC_WEN_NOUN = "Bouc-Wen hysteresis"

BOUC_WEN_EXPERIMENT = "Move {place} slowly through growing loops, and draw force over displacement."


def loops(signals: Signals, reach: float) -> Iterator[Guess]:
    """Loops that yield early or late, that bulge (gamma > 0) or pinch and stiffen (gamma < 0)."""
    for share, n, beta, gamma in (
        (0.12, 1.0, 0.65, 0.35),
        (0.3, 1.0, 0.65, 0.35),
        (0.3, 2.0, 0.65, 0.35),
        (0.8, 1.0, 0.65, 0.35),
        (0.8, 1.0, 0.5, -0.5),
        (2.0, 1.0, 0.5, -0.7),
    ):
        z = share * reach
        alpha, total = TRIAL_FORCE * signals.size / min(z, reach), z**-n
        values = {"alpha": alpha, "A": 1.0, "beta": beta * total, "gamma": gamma * total, "n": n}
        yield Guess(values, ("alpha",), fixed=("A",))


@register
class BoucWen(PlantLaw):
    """Hysteretic spring of Bouc and Wen."""

    kind = "bouc_wen"
    between_dofs = True
    flexible = True
    blocks = ("plant",)
    parameters = BOUC_WEN_PARAMETERS
    equation = "F = -alpha z; dz/dt = A v - beta |v| |z|^(n-1) z - gamma v |z|^n"
    depends_on = ("x", "v")
    words = (
        "the spring at {dof} is hysteretic (Bouc-Wen): its force depends on where the motion last turned; "
        "in small motions it adds a stiffness of {alpha}"
    )
    noun = BOUC_WEN_NOUN
    experiment = BOUC_WEN_EXPERIMENT
    possible = BOUC_WEN_POSSIBLE
    secondary = BOUC_WEN_SECONDARY
    powers = BOUC_WEN_POWERS
    along = BOUC_WEN_ALONG
    plainer = (Plainer(CoulombFriction.kind, lambda p: {"force": yield_force(p)}),)
    states = 1
    partition = "velocity"
    kinked = True
    rank = 80

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Loops of a hysteretic spring."""
        yield from loops(signals, rms(signals.x - signals.x.mean()))

    @staticmethod
    def steepest(p: Values) -> tuple[float, float]:
        """Slope near zero, where the convention A = 1 holds."""
        return p["alpha"], 0.0

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return -p[0] * z[0]

    @staticmethod
    def rate(x, v, z, t, p, mode, dz):  # type: ignore[no-untyped-def]
        size = abs(z[0]) ** (p[4] - 1.0) if p[4] != 1.0 else 1.0
        dz[0] = v * (p[1] - size * (p[2] * mode * z[0] + p[3] * abs(z[0])))

    @staticmethod
    def initial(x, p):  # type: ignore[no-untyped-def]
        return (0.0,)
