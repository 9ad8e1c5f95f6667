"""Masses that change: what joins a dof, or leaves it, while it moves.

It joins or leaves with the velocity of the dof, as sand that trickles out does, so that it adds no thrust:
all that changes is what the forces have to accelerate.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import INSTANTS, TRIAL_FORCE, Guess, Signals, instants, rms
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import Seen, Values
from rthm_core.effects.registry import register

MOST_LOST = 0.9
"""Share of the mass of a dof up to which a fit may take it away."""

EARLY = 0.1
"""Part of the time to the first of the instants at which a fit may begin at which it may begin, too: what
changes so soon is nearly another mass throughout."""

SPANS = (1, 3)
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
        at, change = instants(signals.time, signals.a), _trial(signals)
        parts = np.diff(at)

        def guess(begin: float, within: float, apart: float) -> Guess:
            values = {"change": change, "at": begin, "within": within}
            return Guess(
                values, ("change",), signed=True, fixed=() if within else ("within",), scales={"at": apart}
            )

        yield guess(at[0] + EARLY * parts[0], 0.0, parts[0])
        yield from (guess(begin, 0.0, apart) for begin, apart in zip(at[1:], parts, strict=True))
        for span in SPANS:
            for begin, end, apart in zip(at[:-span], at[span:], parts, strict=False):
                yield guess(begin + 0.5 * apart, end - begin, apart)

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
        rate = _trial(signals) / float(signals.time[-1])
        yield Guess({"rate": rate, "at": 0.0}, ("rate",), signed=True, fixed=("at",))
        at = instants(signals.time, signals.a)
        for begin, apart in zip(at[1 : INSTANTS // 2], np.diff(at), strict=False):
            values, scales = {"rate": rate, "at": float(begin)}, {"at": apart}
            yield Guess(values, ("rate",), signed=True, scales=scales)

    @staticmethod
    def inertia(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        return p[0] * (t - p[1]) * mode

    @staticmethod
    def thresholds(p):  # type: ignore[no-untyped-def]
        return (p[1],)
