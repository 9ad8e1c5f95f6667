"""How big an effect is: parameters that make it act at a given size in a given test.

A size is the share of the wire's force (rms) that the effect has, or what moves the recorded channels about
as much: 0.02 is small, 0.05 medium, 0.15 large.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from benchmarks.concealed.world import wire_stiffness

Values = dict[str, Any]


@dataclass
class Scene:
    """What the parameters of an effect are scaled by: the test without it."""

    spec: dict[str, Any]
    pilot: np.ndarray  # (n1, 4): x1, v1, u, F
    rng: np.random.Generator
    known: np.ndarray = field(default_factory=lambda: np.zeros(1))  # N: load w1 at the pilot's samples

    def __post_init__(self) -> None:
        x, v, u, F = self.pilot.T
        self.x, self.v, self.F, self.d = (float(np.sqrt(np.mean(s**2))) for s in (x, v, F, u - x))
        self.w = self.v / self.x  # rad/s, where most of the motion is
        self.k_tot = wire_stiffness(self.spec["actuator"])

    def between(self, low: float, high: float) -> float:
        """Draw evenly on a logarithmic scale."""
        return float(np.exp(self.rng.uniform(np.log(low), np.log(high))))

    def sign(self) -> float:
        """+1 or -1."""
        return float(self.rng.choice([-1.0, 1.0]))

    def level(self, signal: int, share: float) -> float:
        """Magnitude that a signal of the pilot exceeds for this share of the time; the least from 1 on."""
        return float(np.quantile(np.abs(self.pilot[:, signal]), max(1.0 - share, 0.0)))


def stribeck(size: float, s: Scene) -> Values:
    """Breaks away at 1.3 to 2 times the sliding force."""
    force = size * s.F
    return {
        "coulomb_force": force,
        "static_force": force * s.between(1.3, 2.0),
        "stribeck_velocity": s.v * s.between(0.05, 0.3),
    }


def beyond(size: float, s: Scene, depth: np.ndarray) -> float:
    """Stiffness of a spring that is compressed by `depth` where positive."""
    return size * s.F / float(np.sqrt(np.mean(np.maximum(depth, 0.0) ** 2)))


def end_stop(size: float, s: Scene) -> Values:
    """Spring reached for 3 to 20 % of the time, on either side."""
    side = s.sign()
    x = side * s.pilot[:, 0]
    position = max(float(np.quantile(x, 1.0 - s.rng.uniform(0.03, 0.2))), 0.2 * s.x)
    stiffness = beyond(size, s, x - position)
    return {
        "position": side * position,
        "stiffness": stiffness,
        "damping": stiffness * s.between(0.001, 0.02),
    }


def clearance(size: float, s: Scene) -> Values:
    """Spring reached for 15 to 50 % of the time."""
    gap = s.level(0, s.rng.uniform(0.15, 0.5))
    return {"gap": gap, "stiffness": beyond(size, s, np.abs(s.pilot[:, 0]) - gap)}


def bouc_wen(size: float, s: Scene, reach: float, n: int) -> Values:
    """Yields at `reach` times 0.15 to 0.6; the loop bulges or pinches with gamma."""
    z = reach * s.between(0.15, 0.6)
    share = s.rng.uniform(0.4, 0.9)
    total = z**-n
    return {
        "alpha": size * s.F / z,
        "A": 1.0,
        "beta": share * total,
        "gamma": (1.0 - share) * total,
        "n": float(n),
    }


def branch(force: float, motion: float, s: Scene) -> Values:
    """Branch with this force under this motion at the main frequency, relaxing 0.4 to 4 times as fast."""
    wT = 1.0 / s.between(0.4, 4.0)
    stiffness = force / motion * np.hypot(1.0, wT) / wT
    return {"stiffness": stiffness, "damping": stiffness * wT / s.w}


def hidden(size: float, s: Scene) -> Values:
    """A few per cent of the mass, near the main frequency."""
    mass = s.spec["plant"]["mass"][0]
    return {
        "mass": size * mass * s.between(0.1, 0.5),
        "frequency": s.w * s.between(0.7, 3.0),
        "damping_ratio": s.between(0.01, 0.1),
    }


def fluid(size: float, s: Scene) -> Values:
    """Peaks near the main frequency, where the gain is judged."""
    w, zeta = s.w * s.between(0.6, 2.5), s.between(0.1, 0.6)
    response = abs(s.w / complex(w**2 - s.w**2, 2.0 * zeta * w * s.w))
    return {"gain": size * s.F / (s.v * response), "frequency": w, "damping_ratio": zeta}


def pulley(size: float, s: Scene) -> Values:
    """Mass felt at the wire, well below the plant's."""
    return {"mass": size * s.between(0.2, 0.8), "damping": s.between(0.02, 0.2)}


def harmonic(size: float, s: Scene) -> Values:
    """Anywhere in the band of the loads."""
    return {
        "amplitude": 1.4 * size * s.F,
        "frequency": s.rng.uniform(1.0, 15.0),
        "phase": s.rng.uniform(-np.pi, np.pi),
    }


def cube(size: float, s: Scene) -> Values:
    """Cubic stiffness of the plant."""
    return {"coefficient": size * s.F / float(np.sqrt(np.mean(s.pilot[:, 0] ** 6)))}


def square(size: float, s: Scene) -> Values:
    """Quadratic stiffness of the plant, either sign."""
    return {"coefficient": s.sign() * size * s.F / float(np.sqrt(np.mean(s.pilot[:, 0] ** 4)))}


def mass_change(size: float, s: Scene) -> Values:
    """Mass of either sign, within the first periods, at once or slowly."""
    period = 2.0 * np.pi / s.w
    within = period * s.between(0.1, 1.0) if s.rng.random() < 0.5 else 0.0
    change = s.sign() * size * s.F / (s.w * s.v)
    return {"change": change, "at": period * s.between(0.1, 1.0), "within": within}


def growing_mass(size: float, s: Scene) -> Values:
    """Twice the size after twenty periods."""
    period = 2.0 * np.pi / s.w
    return {"rate": 0.1 * size * s.F / (s.w * s.v) / period, "at": period * s.between(0.05, 0.5)}


def drag(size: float, s: Scene) -> Values:
    """Quadratic drag."""
    return {"coefficient": size * s.F / float(np.sqrt(np.mean(s.pilot[:, 1] ** 4)))}


def hardening(size: float, s: Scene) -> Values:
    """Cubic stiffness of the wire."""
    d = s.pilot[:, 2] - s.pilot[:, 0]
    return {"coefficient": size * s.F / float(np.sqrt(np.mean(d**6)))}


def second_order(size: float, s: Scene) -> Values:
    """Slower where it is larger."""
    return {"frequency": 25.0 / size * s.between(0.7, 1.4), "damping_ratio": s.between(0.3, 1.0)}


def wrong(names: tuple[str, ...]) -> Callable[[float, Scene], Values]:
    """One of the named spec entries, wrong by `size`; a damping by six times that."""

    def values(size: float, s: Scene) -> Values:
        name = str(s.rng.choice(names))
        section, key = name.split(".")
        right = s.k_tot if name == "actuator.stiffness" else s.spec[section][key][0]
        factor = 1.0 + size * (6.0 if key == "damping" else s.sign())
        return {"name": name, "value": right * factor}

    return values
