"""Linear physics with states of its own: relaxation, resonators, fluid memory."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals, rms
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import Plainer, Twin, Values, between, in_band, less_than_the_dof, relaxing
from rthm_core.effects.registry import register

LARGEST_DAMPING_RATIO = 2.0
"""Largest damping ratio of a memory: beyond, it has no peak and relaxes."""


MAXWELL_NOUN = "relaxation (a Maxwell branch)"

MAXWELL_EXPERIMENT = "Hold {place} after a step, and watch the force relax."


def relaxations(signals: Signals, reach: float) -> Iterator[Guess]:
    """Branches that relax slower than, as fast as and faster than a motion of this size."""
    for ratio in (0.3, 1.0, 3.0):
        k = TRIAL_FORCE * signals.size / reach
        values = {"stiffness": k, "damping": k / (ratio * signals.frequency)}
        yield Guess(values, ("stiffness", "damping"))


@register
class MaxwellBranch(PlantLaw):
    """Spring and damper in series beside the plant's own spring: a force that relaxes.

    The state is the displacement of the damper, so that no velocity is needed.
    """

    kind = "maxwell_branch"
    between_dofs = True
    flexible = True
    blocks = ("plant",)
    parameters = {
        "stiffness": EffectParameter("N/m", "spring of the branch", minimum=0.0),
        "damping": EffectParameter("N s/m", "damper in series with it", minimum=1e-12),
    }
    equation = "F = -k (x - y); c dy/dt = k (x - y)"
    depends_on = ("x", "v")
    words = (
        "the spring at {dof} relaxes: a branch of {stiffness} in series with {damping} acts beside "
        "it (Maxwell)"
    )
    noun = MAXWELL_NOUN
    experiment = MAXWELL_EXPERIMENT
    possible = {"damping": relaxing}
    states = 1
    linear = True
    rank = 90

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Relaxation slower than, as fast as and faster than the motion."""
        yield from relaxations(signals, rms(signals.x - signals.x.mean()))

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return -p[0] * (x - z[0])

    @staticmethod
    def rate(x, v, z, t, p, mode, dz):  # type: ignore[no-untyped-def]
        dz[0] = p[0] / p[1] * (x - z[0])

    @staticmethod
    def initial(x, p):  # type: ignore[no-untyped-def]
        return (x,)


def peak(p: Values) -> dict[str, float]:
    """Where and how sharply a memory peaks, from its parameters."""
    return {"frequency": p["frequency"], "damping_ratio": p["damping_ratio"]}


@register
class HiddenMode(PlantLaw):
    """Resonator hung on the dof: a mass that nobody measures."""

    kind = "hidden_mode"
    flexible = True
    blocks = ("plant",)
    parameters = {
        "mass": EffectParameter("kg", "mass of the resonator", minimum=0.0),
        "frequency": EffectParameter("rad/s", "its natural frequency with the dof held", minimum=1e-9),
        "damping_ratio": EffectParameter("1", "its damping ratio", minimum=0.0),
    }
    equation = "F = m (w^2 (y - x) + 2 zeta w (dy - v)); m ddy = -F"
    depends_on = ("x", "v")
    words = "a hidden resonator of {mass} at {frequency} hangs on {dof}"
    noun = "a hidden resonator"
    experiment = "Sweep a sine slowly through the suspected resonance."
    repeats = True
    possible = {"mass": less_than_the_dof, "frequency": in_band, "damping_ratio": between(0.0, 1.0)}
    secondary = ("damping_ratio",)
    twins = (Twin("fluid_memory", lambda p: {"gain": p["mass"] * p["frequency"] ** 2, **peak(p)}),)
    states = 2
    linear = True
    rank = 100

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Resonators below, at and above the main frequency."""
        for ratio in np.geomspace(0.45, 4.0, 14):
            frequency = float(ratio) * signals.frequency
            values = {"mass": 0.01 * signals.mass, "frequency": frequency, "damping_ratio": 0.05}
            yield Guess(values, ("mass",))

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return p[0] * (p[1] * p[1] * (z[0] - x) + 2.0 * p[2] * p[1] * (z[1] - v))

    @staticmethod
    def rate(x, v, z, t, p, mode, dz):  # type: ignore[no-untyped-def]
        dz[0] = z[1]
        dz[1] = -p[1] * p[1] * (z[0] - x) - 2.0 * p[2] * p[1] * (z[1] - v)

    @staticmethod
    def initial(x, p):  # type: ignore[no-untyped-def]
        return (x, 0.0)


@register
class FluidMemory(PlantLaw):
    """Radiation force of a floating body: the waves that it made act back on it."""

    kind = "fluid_memory"
    flexible = True
    blocks = ("plant",)
    parameters = {
        "gain": EffectParameter("N/m", "force per state rate", minimum=0.0),
        "frequency": EffectParameter("rad/s", "frequency at which the memory peaks", minimum=0.0),
        "damping_ratio": EffectParameter("1", "width of the peak", minimum=0.0),
    }
    equation = "F = -gain dr; ddr + 2 zeta w dr + w^2 r = v"
    depends_on = ("v",)
    words = (
        "the waves that {dof} makes in the fluid act back on it (radiation force): strongest near "
        "{frequency}, with a gain of {gain}"
    )
    noun = "radiation of a fluid"
    experiment = "Sweep a sine slowly, and record a decay in air."
    possible = {"frequency": in_band, "damping_ratio": between(0.0, LARGEST_DAMPING_RATIO)}
    secondary = ("damping_ratio",)
    plainer = (
        Plainer(
            "maxwell_branch",
            lambda p: {
                "stiffness": p["gain"],
                "damping": p["gain"] / max(2.0 * p["damping_ratio"] * p["frequency"], 1e-12),
            },
        ),
    )
    twins = (Twin("hidden_mode", lambda p: {"mass": p["gain"] / p["frequency"] ** 2, **peak(p)}),)
    states = 2
    linear = True
    rank = 110

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """Memory that peaks below, at and above the main frequency."""
        gain = TRIAL_FORCE * signals.size / rms(signals.v) * signals.frequency
        for ratio in (0.5, 0.8, 1.2, 1.8, 2.7):
            values = {"gain": gain, "frequency": ratio * signals.frequency, "damping_ratio": 0.3}
            yield Guess(values, ("gain",))

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return -p[0] * z[1]

    @staticmethod
    def rate(x, v, z, t, p, mode, dz):  # type: ignore[no-untyped-def]
        dz[0] = z[1]
        dz[1] = v - 2.0 * p[2] * p[1] * z[1] - p[1] * p[1] * z[0]

    @staticmethod
    def initial(x, p):  # type: ignore[no-untyped-def]
        return (0.0, 0.0)
