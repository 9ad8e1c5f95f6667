"""Forces on the plant that no library of kinds has.

Every law has a code and a row of parameters q: q[0] the code, q[1] the force A in N, then a length or speed
that makes its argument dimensionless, instants in s, and so on as `LAWS` lists them. Springs are codes 1 to
19, what depends on the velocity 20 to 39, on the time 40 to 59, on the known load 60 to 69; inner states 70
to 79, changes of the mass 80 to 89 (A in kg), dry friction from 100 on.
"""

from __future__ import annotations

import numpy as np
from numba import njit

# Name of a law -> code, names of its parameters behind A.
LAWS: dict[str, tuple[int, tuple[str, ...]]] = {
    "magnet": (1, ("distance",)),
    "cogging": (2, ("pitch", "phase")),
    "tanh_spring": (3, ("x",)),
    "sine_stiffness": (4, ("x",)),
    "exponential_spring": (5, ("x",)),
    "quintic_spring": (6, ("x",)),
    "detent": (7, ("centre", "width")),
    "position_damping": (20, ("x", "v")),
    "fractional_drag": (21, ("v", "power")),
    "feeding": (22, ("x", "v")),
    "cubic_damping": (23, ("v",)),
    "speed_governor": (24, ("v",)),
    "local_damper": (25, ("v", "edge")),
    "cross_force": (26, ("x", "v")),
    "surface": (27, ("x", "v", *(f"{k}{i}" for i in range(6) for k in ("weight", "at_x", "at_v")))),
    "parametric_stiffness": (40, ("x", "frequency", "phase")),
    "stepping_stiffness": (41, ("x", "instant")),
    "drifting_stiffness": (42, ("x", "until")),
    "stepping_damping": (43, ("v", "instant")),
    "drifting_damping": (44, ("v", "until")),
    "catching_cable": (45, ("x", "edge", "begin", "end")),
    "rubbing_seal": (46, ("v", "begin", "end")),
    "square_input": (60, ("load",)),
    "rectified_input": (61, ("load",)),
    "modulated_input": (62, ("load", "x")),
    "lugre": (70, ("bristle", "v", "rise")),
    "nonlinear_absorber": (71, ("mass", "x", "frequency", "damping_ratio")),
    "stepping_mass": (80, ("instant",)),
    "drifting_mass": (81, ("until",)),
    "interval_friction": (100, ("low", "high")),
    "asymmetric_friction": (101, ("tilt",)),
    "growing_friction": (102, ("until",)),
    "wedge_friction": (103, ("x",)),
    "stepping_friction": (104, ("instant",)),
    "sloping_friction": (105, ("x",)),
}
CODES = {name: code for name, (code, _) in LAWS.items()}
HIDDEN_LOADS = ("random_load", "wandering_load", "knocks")


@njit
def force(t: float, x: float, v: float, w1: float, z: float, dz: float, q: np.ndarray) -> float:
    """Force at t under the motion x, v, the known load w1 and the inner state z, dz; without dry friction."""
    code = q[0]
    if code < 20.0:
        return q[1] * spring(x, q)
    if code < 40.0:
        return q[1] * damper(x, v, q)
    if code < 60.0:
        return q[1] * timed(t, x, v, q)
    if code < 70.0:
        return q[1] * driven(x, w1, q)
    if code < 80.0:
        return inner_force(x, v, z, dz, q)
    return 0.0


@njit
def spring(x: float, q: np.ndarray) -> float:
    """Laws of the position alone, of size 1."""
    code, s = q[0], x / q[2]
    if code == 1.0:
        return 1.0 / max(1.0 - s, 0.05) ** 2 - 1.0
    if code == 2.0:
        return np.sin(2.0 * np.pi * s + q[3])
    if code == 3.0:
        return -np.tanh(s)
    if code == 4.0:
        return -np.sin(s)
    if code == 5.0:
        return -(np.exp(s) - 1.0)
    if code == 6.0:
        return -(s**5)
    s = (x - q[2]) / q[3]
    return -s * np.exp(-(s**2))


@njit
def damper(x: float, v: float, q: np.ndarray) -> float:
    """Laws of velocity, and position, of size 1."""
    code = q[0]
    if code == 20.0:
        return -((x / q[2]) ** 2) * v / q[3]
    if code == 21.0:
        return -np.sign(v) * abs(v / q[2]) ** q[3]
    if code == 22.0:
        return (1.0 - (x / q[2]) ** 2) * v / q[3]
    if code == 23.0:
        return -((v / q[2]) ** 3)
    if code == 24.0:
        return -np.sign(v) * max(abs(v) / q[2] - 1.0, 0.0)
    if code == 25.0:
        return -v / q[2] if x > q[3] else 0.0
    if code == 26.0:
        return x / q[2] * v / q[3]
    f = 0.0
    for i in range(6):
        f += q[4 + 3 * i] * np.exp(-((x / q[2] - q[5 + 3 * i]) ** 2) - (v / q[3] - q[6 + 3 * i]) ** 2)
    return f


@njit
def timed(t: float, x: float, v: float, q: np.ndarray) -> float:
    """Laws that change with time, of size 1."""
    code = q[0]
    if code == 40.0:
        return -np.sin(q[3] * t + q[4]) * x / q[2]
    if code == 41.0 or code == 43.0:
        s = x if code == 41.0 else v
        return -s / q[2] if t > q[3] else 0.0
    if code == 42.0 or code == 44.0:
        s = x if code == 42.0 else v
        return -s / q[2] * t / q[3]
    if code == 45.0:
        return -max(x - q[3], 0.0) / q[2] if q[4] < t < q[5] else 0.0
    return -v / q[2] if q[3] < t < q[4] else 0.0


@njit
def driven(x: float, w1: float, q: np.ndarray) -> float:
    """Laws of the known load, of size 1."""
    s = w1 / q[2]
    if q[0] == 60.0:
        return abs(s) * s - s
    return abs(s) if q[0] == 61.0 else s * x / q[3]


@njit
def inner_force(x: float, v: float, z: float, dz: float, q: np.ndarray) -> float:
    """Laws with a state of their own: bristles (LuGre), a mass on a hardening spring."""
    if q[0] == 70.0:
        rate, _ = inner_rates(x, v, z, dz, q)
        return -q[1] * (z + 0.1 * q[2] / q[3] * rate) / q[2]
    return absorber_force(x, v, z, dz, q)


@njit
def absorber_force(x: float, v: float, z: float, dz: float, q: np.ndarray) -> float:
    """Force of the absorber at z on the plant; hardening of the size of its linear spring at q[3]."""
    d = z - x
    w = q[4]
    return q[1] * q[2] * (w**2 * (d + d**3 / q[3] ** 2) + 2.0 * q[5] * w * (dz - v))


@njit
def inner_rates(x: float, v: float, z: float, dz: float, q: np.ndarray) -> tuple[float, float]:
    """Rates of z and dz."""
    if q[0] == 70.0:
        level = 1.0 + q[4] * np.exp(-((v / q[3]) ** 2))
        return v - abs(v) * z / (q[2] * level), 0.0
    if q[0] == 71.0:
        return dz, -absorber_force(x, v, z, dz, q) / (q[1] * q[2])
    return 0.0, 0.0


@njit
def more_mass(t: float, q: np.ndarray) -> float:
    """What has come to the mass at t, in kg."""
    if q[0] == 80.0:
        return q[1] if t > q[2] else 0.0
    return q[1] * t / q[2] if q[0] == 81.0 else 0.0


@njit
def rubs(q: np.ndarray) -> bool:
    """Whether the law is a dry friction."""
    return q[0] >= 100.0


@njit
def friction(t: float, x: float, side: float, q: np.ndarray) -> float:
    """Size of the dry friction at x when moving, or pushed, to the `side`, in N."""
    code = q[0]
    if code < 100.0:
        return 0.0
    if code == 100.0:
        return q[1] if q[2] < x < q[3] else 0.0
    if code == 101.0:
        return q[1] * (1.0 + q[2] * side)
    if code == 102.0:
        return q[1] * t / q[2]
    if code == 103.0:
        return q[1] * abs(x) / q[2]
    if code == 104.0:
        return q[1] if t > q[2] else 0.0
    return q[1] * max(1.0 + x / q[2], 0.0)
