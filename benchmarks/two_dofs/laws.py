"""Forces of one kind each, with equations of their own: those of the contract."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

SLOW = 5e-4
"""Part of the typical speed over which dry friction turns round: what sticks creeps as slowly."""

Rate = tuple[float, float]
"""Force, N, and rate of the law's own state."""


@dataclass(frozen=True)
class Scale:
    """Typical and largest size of position and velocity at a place, and of the force of its spring."""

    x: float
    v: float
    reach: float
    force: float


@dataclass(frozen=True)
class Law:
    """A kind with its parameters, and its force for a position, a velocity and an own state."""

    kind: str
    parameters: dict[str, float]
    force: Callable[[float, float, float], Rate]


def friction(share: float, at: Scale, rng: np.random.Generator) -> Law:
    """Dry friction."""
    size, slow = share * at.force, SLOW * at.v
    return Law("coulomb_friction", {"force": size}, lambda x, v, z: (-size * math.tanh(v / slow), 0.0))


def drag(share: float, at: Scale, rng: np.random.Generator) -> Law:
    """Drag of the square of the speed."""
    c = share * at.force / at.v**2
    return Law("quadratic_drag", {"coefficient": c}, lambda x, v, z: (-c * abs(v) * v, 0.0))


def cubic(share: float, at: Scale, rng: np.random.Generator) -> Law:
    """Spring that hardens."""
    k = share * at.force / at.x**3
    return Law("cubic_stiffness", {"coefficient": k}, lambda x, v, z: (-k * x**3, 0.0))


def play(share: float, at: Scale, rng: np.random.Generator) -> Law:
    """Spring with play."""
    gap = float(rng.uniform(0.3, 0.6)) * at.reach
    k = 2.0 * share * at.force / (at.reach - gap)

    def force(x: float, v: float, z: float) -> Rate:
        return -k * math.copysign(max(abs(x) - gap, 0.0), x), 0.0

    return Law("clearance", {"gap": gap, "stiffness": k}, force)


def branch(share: float, at: Scale, rng: np.random.Generator) -> Law:
    """Spring and damper in series; the state is the stretch of the spring."""
    k = share * at.force / at.x
    c = k * at.x / at.v * float(rng.uniform(0.5, 2.0))
    return Law("maxwell_branch", {"stiffness": k, "damping": c}, lambda x, v, z: (-k * z, v - k / c * z))


def loops(share: float, at: Scale, rng: np.random.Generator) -> Law:
    """Bouc-Wen with n = 1."""
    alpha, beta = share * at.force / at.x, float(rng.uniform(0.5, 1.0)) / at.x
    gamma = 0.5 * beta

    def force(x: float, v: float, z: float) -> Rate:
        return -alpha * z, v - beta * abs(v) * z - gamma * v * abs(z)

    return Law("bouc_wen", {"alpha": alpha, "A": 1.0, "beta": beta, "gamma": gamma, "n": 1.0}, force)


MAKERS = (friction, drag, cubic, play, branch, loops)
