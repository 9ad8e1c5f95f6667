"""Dry friction with exact sticking."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals, rms
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import Plainer, Seen, Values
from rthm_core.effects.registry import register

STEEPEST = 4.0
"""Largest friction at rest over that in motion: dry surfaces have 1.1 to 2, and what falls to nearly nothing
is drag that was left out."""

FALLING = (1e-3, 0.5)
"""Parts of the highest speed over which friction may be seen to fall: over less nobody sees it, and over more
it does not fall off within the motion."""

GROWN, WIDER = (0.95, 1.4), (1.0, 3.0)
"""Parts of a friction that is the same at all speeds from which one that falls may begin, in motion and at
rest, and how much wider it falls than where it was looked for at first.
"""


def _at_rest(p: Values, seen: Seen) -> tuple[float, float]:
    """Friction at rest: no less than in motion."""
    return p["coulomb_force"], STEEPEST * p["coulomb_force"]


def _fallen(p: Values, seen: Seen) -> tuple[float, float]:
    """Speeds over which friction falls within what was reached."""
    if not math.isfinite(seen.speed):
        return 0.0, math.inf
    return FALLING[0] * seen.speed, FALLING[1] * seen.speed


def _falling(plain: Values, guess: Values) -> Iterator[dict[str, float]]:
    """A friction that falls, from the one that fits best and is the same at all speeds."""
    for wider in WIDER:
        yield {
            "coulomb_force": GROWN[0] * plain["force"],
            "static_force": GROWN[1] * plain["force"],
            "stribeck_velocity": wider * guess["stribeck_velocity"],
        }


@register
class CoulombFriction(PlantLaw):
    """Constant friction against the motion; the dof sticks while less than this force pulls at it."""

    kind = "coulomb_friction"
    between_dofs = True
    blocks = ("plant",)
    parameters = {"force": EffectParameter("N", "friction force", minimum=0.0)}
    equation = "F = -F_f sign(v); |F| <= F_f at rest"
    depends_on = ("v",)
    jump = "force"
    words = "dry friction of {force} acts on {dof}"
    noun = "dry friction"
    experiment = "Pull {place} back and forth slowly, at constant speed, and read the force."
    partition = "friction"
    constant = True
    rank = 10
    common = True

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Seen at once in its amplitude."""
        yield Guess({"force": TRIAL_FORCE * signals.size}, ("force",))

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return -p[0] * mode

    @staticmethod
    def breakaway(p):  # type: ignore[no-untyped-def]
        return p[0]


@register
class StribeckFriction(PlantLaw):
    """Friction that is larger at rest than in motion and falls off with speed."""

    kind = "stribeck_friction"
    between_dofs = True
    blocks = ("plant",)
    parameters = {
        "coulomb_force": EffectParameter("N", "friction force at high speed", minimum=0.0),
        "static_force": EffectParameter("N", "friction force at rest", minimum=0.0),
        "stribeck_velocity": EffectParameter(
            "m/s", "speed over which friction falls from static to Coulomb", minimum=1e-9
        ),
    }
    equation = "F = -(F_c + (F_s - F_c) exp(-(v/v_s)^2)) sign(v); |F| <= F_s at rest"
    depends_on = ("v",)
    jump = "static_force"
    words = (
        "dry friction acts on {dof}: {static_force} before it moves, falling to {coulomb_force} "
        "as the speed grows beyond {stribeck_velocity} (Stribeck effect)"
    )
    noun = "Stribeck friction"
    experiment = "Start {place} from rest several times, at several low speeds."
    possible = {"static_force": _at_rest, "stribeck_velocity": _fallen}
    plainer = (
        Plainer(
            "coulomb_friction",
            lambda p: {"force": p["coulomb_force"]},
            grows=("coulomb_force", "static_force"),
            beyond=_falling,
        ),
    )
    partition = "friction"
    rank = 20

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Two widths of the fall from static to sliding friction."""
        force = TRIAL_FORCE * signals.size
        for width in (0.05, 0.2):
            values = {
                "coulomb_force": force,
                "static_force": 1.6 * force,
                "stribeck_velocity": width * rms(signals.v),
            }
            yield Guess(values, ("coulomb_force", "static_force"), apart=True)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        ratio = v / p[2]
        return -(p[0] + (p[1] - p[0]) * math.exp(-ratio * ratio)) * mode

    @staticmethod
    def breakaway(p):  # type: ignore[no-untyped-def]
        return p[1]
