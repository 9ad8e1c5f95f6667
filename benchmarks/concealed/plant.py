"""The physical substructure: M1 a1 = -c1 v1 - k1 x1 + F + w1 + effects."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from benchmarks.concealed import strange
from benchmarks.concealed.loads import load
from benchmarks.concealed.states import (
    HUNG,
    HUNG_RATE,
    INNER,
    INNER_RATE,
    RELAX,
    V1,
    WAVE,
    WAVE_RATE,
    X1,
    YIELD,
)
from numba import njit


class Plant(NamedTuple):
    """Parameters; zero switches an effect off."""

    mass: float
    damping: float
    stiffness: float
    coulomb_force: float  # N
    static_force: float  # N
    stribeck_velocity: float  # m/s
    drag: float  # N s^2/m^2
    cubic: float  # N/m^3
    quadratic: float  # N/m^2
    stop_position: float  # m
    stop_stiffness: float
    stop_damping: float
    clearance_gap: float  # m
    clearance_stiffness: float
    alpha: float  # Bouc-Wen
    A: float
    beta: float
    gamma: float
    n: float
    branch: float  # Maxwell
    branch_damping: float
    hung_mass: float  # hidden mode
    hung_frequency: float
    hung_damping_ratio: float
    wave_gain: float  # fluid memory
    wave_frequency: float
    wave_damping_ratio: float
    joining: float  # kg, mass that joins at an instant, within some time
    joining_at: float  # s
    joining_within: float
    growing: float  # kg/s, mass that joins from an instant on
    growing_from: float
    load_constant: float  # N, loads that nobody recorded
    load_amplitude: float
    load_frequency: float
    load_phase: float
    strange: np.ndarray  # code and parameters of a law that no library has; code 0: none
    hidden_load: np.ndarray  # table of a load that nobody recorded


@njit
def rubs(plant: Plant) -> bool:
    """Whether there is dry friction at all."""
    return plant.static_force > 0.0 or strange.rubs(plant.strange)


@njit
def friction(t: float, x1: float, v1: float, side: float, plant: Plant) -> float:
    """Size of the dry friction at speed v1 to the `side` (+1, -1), in N."""
    more = plant.static_force - plant.coulomb_force
    f = plant.coulomb_force + more * np.exp(-((v1 / plant.stribeck_velocity) ** 2))
    return f + strange.friction(t, x1, side, plant.strange) if strange.rubs(plant.strange) else f


@njit
def mass(t: float, plant: Plant) -> float:
    """Mass that moves at t, in kg."""
    return plant.mass + joined(t, plant) + strange.more_mass(t, plant.strange)


@njit
def joined(t: float, plant: Plant) -> float:
    """Mass that has joined by t, or left, in kg."""
    more = plant.growing * max(t - plant.growing_from, 0.0)
    if t < plant.joining_at:
        return more
    if t < plant.joining_at + plant.joining_within:
        return more + plant.joining * (t - plant.joining_at) / plant.joining_within
    return more + plant.joining


@njit
def span_of_time(t: float, plant: Plant) -> int:
    """Between which instants of its mass t lies, so that no step crosses one."""
    begun, ended = t >= plant.joining_at, t >= plant.joining_at + plant.joining_within
    return int(begun) + 2 * int(ended) + 4 * int(t >= plant.growing_from)


@njit
def contact(x1: float, v1: float, plant: Plant) -> float:
    """End stop and clearance, in N."""
    f = 0.0
    if touches(x1, plant):
        f -= plant.stop_stiffness * (x1 - plant.stop_position) + plant.stop_damping * v1
    if abs(x1) > plant.clearance_gap:
        f -= plant.clearance_stiffness * (x1 - plant.clearance_gap * np.sign(x1))
    return f


@njit
def touches(x1: float, plant: Plant) -> bool:
    """Whether the end stop is reached: it lies on the side of its sign."""
    return x1 > plant.stop_position if plant.stop_position >= 0.0 else x1 < plant.stop_position


@njit
def effects(t: float, w1: float, y: np.ndarray, plant: Plant) -> float:
    """Force of all effects but dry friction, in N, + along +x; w1 is the known load."""
    x1, v1 = y[X1], y[V1]
    f = -plant.drag * abs(v1) * v1 - plant.cubic * x1**3 - plant.quadratic * x1**2
    f += contact(x1, v1, plant)
    f -= plant.alpha * y[YIELD] + plant.branch * (x1 - y[RELAX]) + plant.wave_gain * y[WAVE_RATE]
    f += hung_force(y, plant)
    f += plant.load_constant
    if plant.load_amplitude != 0.0:
        f += plant.load_amplitude * np.sin(plant.load_frequency * t + plant.load_phase)
    if plant.strange[0] != 0.0:
        f += strange.force(t, x1, v1, w1, y[INNER], y[INNER_RATE], plant.strange)
    return f + load(t, plant.hidden_load) if plant.hidden_load.shape[0] > 2 else f


@njit
def hung_force(y: np.ndarray, plant: Plant) -> float:
    """Force of the hidden mode on the plant, in N."""
    w = plant.hung_frequency
    return plant.hung_mass * (
        w**2 * (y[HUNG] - y[X1]) + 2.0 * plant.hung_damping_ratio * w * (y[HUNG_RATE] - y[V1])
    )


@njit
def net_force(t: float, F: float, w1: float, y: np.ndarray, plant: Plant) -> float:
    """All that acts on the mass but dry friction, in N."""
    return -plant.damping * y[V1] - plant.stiffness * y[X1] + F + w1 + effects(t, w1, y, plant)


@njit
def rates(y: np.ndarray, plant: Plant, dy: np.ndarray) -> None:
    """States of the effects."""
    v1 = y[V1]
    if plant.alpha != 0.0:
        z = y[YIELD]
        dy[YIELD] = (
            plant.A * v1
            - plant.beta * abs(v1) * abs(z) ** (plant.n - 1.0) * z
            - plant.gamma * v1 * abs(z) ** plant.n
        )
    if plant.branch != 0.0:
        dy[RELAX] = plant.branch / plant.branch_damping * (y[X1] - y[RELAX])
    if plant.hung_mass != 0.0:
        dy[HUNG] = y[HUNG_RATE]
        dy[HUNG_RATE] = -hung_force(y, plant) / plant.hung_mass
    if plant.wave_gain != 0.0:
        w = plant.wave_frequency
        dy[WAVE] = y[WAVE_RATE]
        dy[WAVE_RATE] = v1 - 2.0 * plant.wave_damping_ratio * w * y[WAVE_RATE] - w**2 * y[WAVE]
    if 70.0 <= plant.strange[0] < 80.0:
        dy[INNER], dy[INNER_RATE] = strange.inner_rates(y[X1], v1, y[INNER], y[INNER_RATE], plant.strange)


@njit
def region(y: np.ndarray, plant: Plant) -> int:
    """Which smooth piece of the contacts and of the hysteresis holds: a step must not cross a kink."""
    piece = 0
    if plant.stop_stiffness > 0.0 and touches(y[X1], plant):
        piece += 1
    if plant.clearance_stiffness != 0.0 and abs(y[X1]) > plant.clearance_gap:
        piece += 2
    if (plant.alpha != 0.0 or plant.drag != 0.0) and y[V1] > 0.0:
        piece += 4
    return piece
