"""Contacts that open and close with position."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from rthm_core.effects.declaration import EffectParameter
from rthm_core.effects.guess import TRIAL_FORCE, Guess, Signals, rms
from rthm_core.effects.laws import PlantLaw
from rthm_core.effects.possible import SURE, Seen, Values, between
from rthm_core.effects.registry import register

DAMPED = 10.0
"""Largest damping force of a stop, over the largest force of its spring."""


def _reached(p: Values, seen: Seen) -> tuple[float, float]:
    """Positions of a stop on its side of rest, within the motion."""
    if p["position"] >= 0.0:
        return seen.margin, seen.highest - seen.margin
    return seen.lowest + seen.margin, -seen.margin


def _sprung(p: Values, seen: Seen) -> tuple[float, float]:
    """Damping of a stop that is a spring all the same; with more it is a damper beyond a position."""
    depth = max(seen.highest - p["position"] if p["position"] >= 0.0 else p["position"] - seen.lowest, 0.0)
    known = math.isfinite(depth) and seen.speed > 0.0
    return 0.0, DAMPED * p["stiffness"] * depth / seen.speed if known else math.inf


def _played(p: Values, seen: Seen) -> tuple[float, float]:
    """Gaps that the motion leaves."""
    return seen.margin, max(-seen.lowest, seen.highest) - seen.margin


@register
class EndStop(PlantLaw):
    """Spring and damper that act beyond a position: above it when the position is positive, below it when
    negative.
    """

    kind = "end_stop"
    between_dofs = True
    flexible = True
    blocks = ("plant",)
    parameters = {
        "position": EffectParameter("m", "where the stop begins; its sign says on which side"),
        "stiffness": EffectParameter("N/m", "stiffness of the stop", minimum=0.0),
        "damping": EffectParameter("N s/m", "damping of the stop", minimum=0.0),
    }
    equation = "F = -k (x - p) - c v where x is beyond p"
    depends_on = ("x", "v")
    words = "a stop at {position}, with a stiffness of {stiffness}, catches {dof}"
    noun = "an end stop"
    experiment = "Push {place} slowly against the stop."
    possible = {"position": _reached, "damping": _sprung}
    secondary = ("damping",)
    within = {"position": SURE}
    partition = "position"
    rank = 60

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """A stop on either side, reached for 2 to 30 % of the time."""
        for side in (1.0, -1.0):
            for share in (0.02, 0.06, 0.15, 0.3):
                position = float(np.quantile(side * signals.x, 1.0 - share))
                if position <= 0.0:
                    continue
                depth = rms(np.maximum(side * signals.x - position, 0.0))
                if depth <= 0.0:
                    continue
                k = TRIAL_FORCE * signals.size / depth
                values = {"position": side * position, "stiffness": k, "damping": 1e-3 * k}
                yield Guess(values, ("stiffness", "damping"), apart=True)

    @staticmethod
    def steepest(p: Values) -> tuple[float, float]:
        """Those of the stop where it is reached."""
        return p["stiffness"], p["damping"]

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        beyond = mode == 1 if p[0] >= 0.0 else mode == 0
        return -p[1] * (x - p[0]) - p[2] * v if beyond else 0.0

    @staticmethod
    def thresholds(p):  # type: ignore[no-untyped-def]
        return (p[0],)


@register
class Clearance(PlantLaw):
    """Spring with play: it acts only beyond a gap on either side."""

    kind = "clearance"
    between_dofs = True
    flexible = True
    blocks = ("plant",)
    parameters = {
        "gap": EffectParameter("m", "half the play", minimum=0.0),
        "stiffness": EffectParameter("N/m", "stiffness beyond the gap"),
    }
    equation = "F = -k (x - gap sign x) where |x| > gap"
    depends_on = ("x",)
    words = "a spring of {stiffness} acts on {dof}, after a play of {gap} to either side"
    noun = "a spring with play"
    experiment = "Push {place} slowly through the gap, both ways."
    possible = {"gap": _played, "stiffness": between(0.0)}
    within = {"gap": SURE}
    partition = "position"
    rank = 70

    @classmethod
    def guesses(cls, signals: Signals) -> Iterator[Guess]:
        """A gap left for 10 to 70 % of the time."""
        for share in (0.1, 0.25, 0.45, 0.7):
            gap = float(np.quantile(np.abs(signals.x), 1.0 - share))
            depth = rms(np.maximum(np.abs(signals.x) - gap, 0.0))
            if depth > 0.0:
                yield Guess({"gap": gap, "stiffness": TRIAL_FORCE * signals.size / depth}, ("stiffness",))

    @staticmethod
    def force(x, v, z, t, p, mode):  # type: ignore[no-untyped-def]
        if mode == 1:
            return 0.0
        return -p[1] * (x - p[0] * (mode - 1))

    @staticmethod
    def thresholds(p):  # type: ignore[no-untyped-def]
        return (-p[0], p[0])
