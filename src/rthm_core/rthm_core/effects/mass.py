"""Masses that change: what joins a dof, or leaves it, while it moves.

It joins or leaves with the velocity of the dof, as sand that trickles out does, so that it adds no thrust:
all that changes is what the forces have to accelerate.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals, rms
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import Seen, Values
from rthm_core.effects.registry import register

MOST_LOST = 0.9
"""Share of the mass of a dof up to which a fit may take it away."""

PLACES = 12
"""Instants within a recording at which a fit may begin."""

EARLY = 0.1
"""Part of the time to the first of them at which a fit may begin, too: what changes so soon is nearly another
mass throughout."""

SPANS = (0.1, 0.3)
"""Parts of a recording that a change takes where a fit of a slow one may begin."""


def within_the_recording(p: Values, seen: Seen) -> tuple[float, float]:
    """Instants and spans of time that a recording shows."""
    return 0.0, seen.duration


def less_than_all(p: Values, seen: Seen) -> tuple[float, float]:
    """Changes that leave some of the mass of the dof."""
    return -MOST_LOST * seen.mass, np.inf


def _trial(signals: Signals) -> float:
    """Mass whose force is of the size of a trial, kg."""
    return TRIAL_FORCE * signals.size / rms(signals.a)


class Joining(PlantLaw):
    """Mass that moves with a dof beside the plant's own, from an instant on."""

    blocks = ("plant",)
    depends_on = ("a", "t")
    partition = "time"
    shown_by = "a"
    experiment = "Weigh {place} before and after the test."

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return 0.0


@register
class MassChange(Joining):
    """Mass that joins a dof, or leaves it, at an instant or within some time."""

    kind = "mass_change"
    parameters = {
        "change": EffectParameter("kg", "mass that joins; negative: that leaves"),
        "at": EffectParameter("s", "instant at which it begins to", minimum=0.0),
        "within": EffectParameter("s", "time that it takes, steadily; 0: at once", minimum=0.0, default=0.0),
    }
    equation = "F = -m a; m goes from 0 to the change"
    words = "the mass that moves with {dof} changes by {change} at {at}"
    noun = "a change of mass"
    rank = 140
    possible = {"change": less_than_all, "at": within_the_recording, "within": within_the_recording}
    secondary = ("within",)

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """At once, and slowly, at instants all over the recording."""
        first, last = float(signals.time[0]), float(signals.time[-1])
        apart = (last - first) / PLACES
        for share in (0.0, *SPANS):
            later = np.arange(first + (0.5 if share else 1.0) * apart, last - share * (last - first), apart)
            for at in (*([] if share else [first + EARLY * apart]), *later):
                values = {"change": _trial(signals), "at": float(at), "within": share * (last - first)}
                fixed = () if share else ("within",)
                yield Guess(values, ("change",), signed=True, fixed=fixed, scales={"at": apart})

    @staticmethod
    def inertia(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        share = 0.5 * mode
        if mode == 1:
            share = (t - p[1]) / p[2]
        return p[0] * share

    @staticmethod
    def thresholds(p):  # type: ignore[no-untyped-def]
        return p[1], p[1] + p[2]


@register
class GrowingMass(Joining):
    """Mass that joins a dof, or leaves it, steadily from an instant on."""

    kind = "growing_mass"
    parameters = {
        "rate": EffectParameter("kg/s", "mass that joins per second; negative: that leaves"),
        "at": EffectParameter("s", "instant from which it does", minimum=0.0, default=0.0),
    }
    equation = "F = -m a; m = rate (t - at)"
    words = "the mass that moves with {dof} changes by {rate} from {at} on"
    noun = "a mass that grows"
    rank = 150
    possible = {"at": within_the_recording}
    secondary = ("at",)

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """From the beginning on, and from instants in the first half."""
        rate, last = _trial(signals) / float(signals.time[-1]), float(signals.time[-1])
        yield Guess({"rate": rate, "at": 0.0}, ("rate",), signed=True, fixed=("at",))
        for at in np.arange(1, PLACES // 2) * last / PLACES:
            values, scales = {"rate": rate, "at": float(at)}, {"at": last / PLACES}
            yield Guess(values, ("rate",), signed=True, scales=scales)

    @staticmethod
    def inertia(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return p[0] * (t - p[1]) * mode

    @staticmethod
    def thresholds(p):  # type: ignore[no-untyped-def]
        return (p[1],)
