"""Forces that come from outside and that nobody listed."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import SURE, Plainer, in_band
from rthm_core.effects.registry import register


@register
class HarmonicLoad(PlantLaw):
    """Unlisted harmonic force.

    It has no guesses of its own: a search takes tones from the spectrum of what a model leaves.
    """

    kind = "harmonic_load"
    flexible = True
    blocks = ("plant",)
    parameters = {
        "amplitude": EffectParameter("N", "amplitude"),
        "frequency": EffectParameter("rad/s", "angular frequency", minimum=0.0),
        "phase": EffectParameter("rad", "phase at the start of the test", default=0.0),
    }
    equation = "F = A sin(w t + phase)"
    depends_on = ("t",)
    words = "a harmonic force of {amplitude} at {frequency}, which the spec does not list, acts on {dof}"
    noun = "an unlisted harmonic force"
    experiment = "Record the rig at rest with everything switched on."
    additive = True
    is_tone = True
    repeats = True
    rank = 130
    possible = {"frequency": in_band}
    secondary = ("phase",)
    within = {"amplitude": SURE}
    plainer = (Plainer("constant_load", lambda p: {"force": p["amplitude"] * math.sin(p["phase"])}),)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return p[0] * math.sin(p[1] * t + p[2])

    @staticmethod
    def excitation(p):  # type: ignore[no-untyped-def]
        return (0.0, p[0], p[1], p[2])


@register
class ConstantLoad(PlantLaw):
    """Unlisted constant force."""

    kind = "constant_load"
    blocks = ("plant",)
    parameters = {"force": EffectParameter("N", "force along +x")}
    equation = "F = F_0"
    words = "a constant force of {force}, which the spec does not list, acts on {dof}"
    noun = "an unlisted constant force"
    experiment = "Record the rig at rest, before and after turning it over."
    additive = True
    power = 0
    rank = 120

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Linear in its force."""
        yield Guess({"force": TRIAL_FORCE * signals.size}, ("force",), signed=True)

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return p[0]

    @staticmethod
    def excitation(p):  # type: ignore[no-untyped-def]
        return (p[0], 0.0, 0.0, 0.0)
