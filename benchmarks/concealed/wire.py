"""The wire: F = k_tot (u - x1), and what can be wrong with it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from benchmarks.concealed.states import (
    DRIVE,
    ELONGATION,
    PULLEY,
    PULLEY_RATE,
    RUB,
    V1,
    WIRE_RELAX,
    WIRE_YIELD,
    X1,
)
from numba import njit


class Wire(NamedTuple):
    """Parameters; zero switches a part off."""

    stiffness: float  # k_tot, N/m
    pretension: float  # N; infinity: never slack
    gap: float  # m
    hardening: float  # N/m^3
    pulley_mass: float  # kg, as felt at the wire
    pulley_damping: float  # N s/m
    motor_side: float  # N/m, spring between motor and pulley
    plant_side: float  # N/m, spring between pulley and plant
    rub: float  # N, friction of the pulley
    alpha: float  # N/m, Bouc-Wen
    A: float
    beta: float
    gamma: float
    n: float  # 1: the only one that is solved here
    branch: float  # N/m, Maxwell
    branch_damping: float
    limp: float  # share of the stiffness that is missing under compression
    bend: float  # m: beyond, the wire gives way (tanh)


@njit
def play(centre: float, last: float, half: float) -> float:
    """Play operator: what is carried along between two walls `half` a width either side of `centre`."""
    return min(max(last, centre - half), centre + half)


@njit
def yielded(z: float, way: float, wire: Wire) -> float:
    """z of Bouc-Wen (n = 1) after the elongation has gone `way` metres without turning.

    Along the path dz/ds = side A - (beta + gamma side sign z) z, so z is exponential up to where it changes
    sign, and again beyond.
    """
    side = 1.0 if way > 0.0 else -1.0
    left = abs(way)
    for _ in range(2):
        sign = side if z == 0.0 else np.sign(z)
        decay = wire.beta + wire.gamma * side * sign
        if sign != side:  # on the way to z = 0
            zero = -z * side / wire.A if decay == 0.0 else np.log1p(decay * -z * side / wire.A) / decay
            if zero < left:
                left -= zero
                z = 0.0
                continue
        if decay == 0.0:
            return z + side * wire.A * left
        final = side * wire.A / decay
        return final + (z - final) * np.exp(-decay * left)
    return z


@njit
def force(u: float, y: np.ndarray, memory: np.ndarray, wire: Wire) -> float:
    """Force of the wire on the plant, in N."""
    k = wire.stiffness
    x1 = y[X1]
    drive = play(u, memory[DRIVE], 0.5 * wire.gap)
    d = drive - x1
    F = k * d
    if wire.pulley_mass > 0.0:
        F = wire.plant_side * (y[PULLEY] - x1)
    if wire.rub > 0.0:
        F = 2.0 * k * (play(0.5 * (drive + x1), memory[RUB], wire.rub / (4.0 * k)) - x1)
    F += wire.hardening * d**3
    if wire.limp > 0.0 and d < 0.0:
        F -= wire.limp * k * d
    if wire.bend > 0.0:
        F += k * (wire.bend * np.tanh(d / wire.bend) - d)
    F += wire.branch * (d - y[WIRE_RELAX])
    if wire.alpha != 0.0:
        F += wire.alpha * yielded(memory[WIRE_YIELD], d - memory[ELONGATION], wire)
    return max(F, -wire.pretension)


@njit
def rates(u: float, y: np.ndarray, memory: np.ndarray, wire: Wire, dy: np.ndarray) -> None:
    """Pulley between two springs; damper of the branch."""
    drive = play(u, memory[DRIVE], 0.5 * wire.gap)
    if wire.pulley_mass > 0.0:
        pull = wire.motor_side * (drive - y[PULLEY]) - wire.plant_side * (y[PULLEY] - y[X1])
        dy[PULLEY] = y[PULLEY_RATE]
        dy[PULLEY_RATE] = (pull - wire.pulley_damping * y[PULLEY_RATE]) / wire.pulley_mass
    if wire.branch > 0.0:
        dy[WIRE_RELAX] = wire.branch / wire.branch_damping * (drive - y[X1] - y[WIRE_RELAX])


@njit
def remember(u: float, y: np.ndarray, memory: np.ndarray, wire: Wire) -> None:
    """Bring the memory of the path up to the present."""
    memory[DRIVE] = play(u, memory[DRIVE], 0.5 * wire.gap)
    if wire.rub > 0.0:
        memory[RUB] = play(0.5 * (memory[DRIVE] + y[X1]), memory[RUB], wire.rub / (4.0 * wire.stiffness))
    d = memory[DRIVE] - y[X1]
    if wire.alpha != 0.0:
        memory[WIRE_YIELD] = yielded(memory[WIRE_YIELD], d - memory[ELONGATION], wire)
    memory[ELONGATION] = d


@njit
def region(u: float, du: float, y: np.ndarray, memory: np.ndarray, wire: Wire) -> int:
    """Whether the wire is slack, and which way it is pulled: a step must not cross a kink or a turn."""
    piece = 0
    if wire.pretension != np.inf and force(u, y, memory, wire) <= -wire.pretension:
        piece += 1
    if wire.gap > 0.0 and du > 0.0:
        piece += 2
    if wire.alpha != 0.0 and du > y[V1]:
        piece += 4
    if wire.rub > 0.0 and du > -y[V1]:
        piece += 8
    return piece
