"""The loop between two events: classical Runge-Kutta with steps that end at kinks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from benchmarks.concealed import motor as motors
from benchmarks.concealed import numerical as numericals
from benchmarks.concealed import plant as plants
from benchmarks.concealed import wire as wires
from benchmarks.concealed.loads import load
from benchmarks.concealed.motor import Motor
from benchmarks.concealed.numerical import Numerical
from benchmarks.concealed.plant import Plant
from benchmarks.concealed.states import MODE, SEEN_F, SEEN_V, SEEN_X, SLEW, STATES, V1, X1
from benchmarks.concealed.wire import Wire
from numba import njit

KINK = 1e-8  # s, how closely a kink is located


class World(NamedTuple):
    """Everything that moves."""

    plant: Plant
    wire: Wire
    motor: Motor
    numerical: Numerical
    load1: np.ndarray  # table of w1
    load2: np.ndarray  # table of w2
    seen_x: float  # s, lags of the sensors
    seen_v: float
    seen_f: float


class Held(NamedTuple):
    """What stays put between events: command at the motor, z1 at the numerical side."""

    command: float
    x1: float
    v1: float


@njit
def wire_force(
    elapsed: float, y: np.ndarray, memory: np.ndarray, held: Held, world: World
) -> tuple[float, float]:
    """Motor position u and wire force F."""
    u = motors.position(motors.slewed(held.command, elapsed, memory, world.motor), y, world.motor)
    return u, wires.force(u, y, memory, world.wire)


@njit
def pull(t: float, elapsed: float, y: np.ndarray, memory: np.ndarray, held: Held, world: World) -> float:
    """Net force on the plant's mass without dry friction, in N."""
    _, F = wire_force(elapsed, y, memory, held, world)
    return plants.net_force(t, F, load(t, world.load1), y, world.plant)


@njit
def acceleration(t: float, net: float, x1: float, v1: float, mode: float, plant: Plant) -> float:
    """a1 under the net force and dry friction; none while the mass sticks."""
    if not plants.rubs(plant):
        return net / plants.mass(t, plant)
    if mode == 0.0:
        return 0.0
    return (net - mode * plants.friction(t, x1, v1, mode, plant)) / plants.mass(t, plant)


@njit
def breaks_away(t: float, net: float, x1: float, plant: Plant) -> bool:
    """Whether the net force moves a mass at rest."""
    return abs(net) > plants.friction(t, x1, 0.0, np.sign(net), plant)


@njit
def rates(
    t: float, elapsed: float, y: np.ndarray, memory: np.ndarray, held: Held, world: World, dy: np.ndarray
) -> None:
    """Time derivative of all states; `elapsed` since the memory was brought up to date."""
    slew = motors.slewed(held.command, elapsed, memory, world.motor)
    u = motors.position(slew, y, world.motor)
    F = wires.force(u, y, memory, world.wire)
    net = plants.net_force(t, F, load(t, world.load1), y, world.plant)
    dy[X1] = y[V1]
    dy[V1] = acceleration(t, net, y[X1], y[V1], memory[MODE], world.plant)
    motors.rates(slew, y, world.motor, dy)
    wires.rates(u, y, memory, world.wire, dy)
    plants.rates(y, world.plant, dy)
    numericals.rates(held.x1, held.v1, load(t, world.load2), y, world.numerical, dy)
    if world.seen_x > 0.0:
        dy[SEEN_X] = (y[X1] - y[SEEN_X]) / world.seen_x
    if world.seen_v > 0.0:
        dy[SEEN_V] = (y[V1] - y[SEEN_V]) / world.seen_v
    if world.seen_f > 0.0:
        dy[SEEN_F] = (F - y[SEEN_F]) / world.seen_f


@njit
def runge_kutta(
    t: float,
    h: float,
    y: np.ndarray,
    memory: np.ndarray,
    held: Held,
    world: World,
    out: np.ndarray,
    work: np.ndarray,
) -> None:
    """One classical step from y into `out`; `work` is (6, states) of scratch."""
    stage = work[4]
    rates(t, 0.0, y, memory, held, world, work[0])
    for i in range(STATES):
        stage[i] = y[i] + 0.5 * h * work[0, i]
    rates(t + 0.5 * h, 0.5 * h, stage, memory, held, world, work[1])
    for i in range(STATES):
        stage[i] = y[i] + 0.5 * h * work[1, i]
    rates(t + 0.5 * h, 0.5 * h, stage, memory, held, world, work[2])
    for i in range(STATES):
        stage[i] = y[i] + h * work[2, i]
    rates(t + h, h, stage, memory, held, world, work[3])
    for i in range(STATES):
        out[i] = y[i] + h / 6.0 * (work[0, i] + 2.0 * (work[1, i] + work[2, i]) + work[3, i])


@njit
def region(t: float, elapsed: float, y: np.ndarray, memory: np.ndarray, held: Held, world: World) -> int:
    """Which smooth piece of the physics holds."""
    piece = plants.region(y, world.plant) + 256 * plants.span_of_time(t, world.plant)
    slew = motors.slewed(held.command, elapsed, memory, world.motor)
    u, du = motors.position(slew, y, world.motor), motors.speed(slew, held.command, y, world.motor)
    piece += 8 * wires.region(u, du, y, memory, world.wire)
    if plants.rubs(world.plant):
        if memory[MODE] == 0.0:
            net = pull(t, elapsed, y, memory, held, world)
            piece += 128 if breaks_away(t, net, y[X1], world.plant) else 0
        else:
            piece += 128 if y[V1] * memory[MODE] < 0.0 else 0
    return piece


@njit
def settle(t: float, y: np.ndarray, memory: np.ndarray, held: Held, world: World) -> None:
    """Let the mass stick or break away; it sticks while the net force is below the static friction."""
    if not plants.rubs(world.plant):
        return
    if y[V1] * memory[MODE] < 0.0 or memory[MODE] == 0.0:
        y[V1] = 0.0
    if y[V1] == 0.0:
        net = pull(t, 0.0, y, memory, held, world)
        memory[MODE] = np.sign(net) if breaks_away(t, net, y[X1], world.plant) else 0.0


@njit
def remember(elapsed: float, y: np.ndarray, memory: np.ndarray, held: Held, world: World) -> None:
    """Bring the memory of the path up to the present."""
    memory[SLEW] = motors.slewed(held.command, elapsed, memory, world.motor)
    wires.remember(motors.position(memory[SLEW], y, world.motor), y, memory, world.wire)


@njit
def advance(
    t: float,
    span: float,
    step: float,
    y: np.ndarray,
    memory: np.ndarray,
    held: Held,
    world: World,
    work: np.ndarray,
) -> None:
    """Move from t over `span` seconds; a step that would cross a kink is halved down to it."""
    end = t + span
    steps = max(np.ceil(span / step), 1.0)
    trial = work[5]
    while end - t > 1e-13:
        settle(t, y, memory, held, world)
        h = min(span / steps, end - t, max(motors.arrival(held.command, memory, world.motor), 1e-12))
        here = region(t, 0.0, y, memory, held, world)
        runge_kutta(t, h, y, memory, held, world, trial, work)
        while h > KINK and region(t + h, h, trial, memory, held, world) != here:
            h *= 0.5
            runge_kutta(t, h, y, memory, held, world, trial, work)
        y[:] = trial
        t += h
        remember(h, y, memory, held, world)
    settle(t, y, memory, held, world)
