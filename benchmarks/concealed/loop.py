"""The event order of the contract, and the plant alone under given commands.

At one instant: (1) every delay tau > 0 that is due is over, the motor's command first; (2) the data
acquisition samples; (3) the numerical substructure; (4) the controller; after each of 2 to 4 a delay of zero
passes at once. A force reference that falls due between two controller ticks changes the command at once (Td4
= 0). Before the test every signal is in steady state at its initial value.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from benchmarks.concealed import foresight
from benchmarks.concealed.foresight import Foresight
from benchmarks.concealed.kept import kept
from benchmarks.concealed.links import NEVER, Link, deliver, next_due, send
from benchmarks.concealed.loads import load
from benchmarks.concealed.motion import Held, World, acceleration, advance, pull, remember, settle, wire_force
from benchmarks.concealed.motor import accepted
from benchmarks.concealed.numerical import interface_force
from benchmarks.concealed.sensors import Sensor, read
from benchmarks.concealed.states import MODE, SEEN_F, SEEN_V, SEEN_X, V1, V2, X1, X2
from numba import njit

# Columns of the recording.
SEEN = slice(0, 4)  # x1, v1, u, F as the sensors show them
TRUE = slice(4, 8)  # the same without sensors
W1, EXTRA_PLANT, EXTRA_WIRE = 8, 9, 10  # N: known load, forces of effects on the plant and in the wire


class Timing(NamedTuple):
    """Periods, motor's own extra delay and duration, in ns."""

    td1: int
    td2: int
    td3: int
    motor_delay: int
    duration: int


class Recording(NamedTuple):
    """Every topic as arrays. `count`: numerical samples, commands, uses of tau1, tau2, tau3, tau4."""

    plant: np.ndarray  # (n1, 11)
    numerical: np.ndarray  # (n2, 4): x2, v2, w2, F_d
    command_stamp: np.ndarray  # ns
    command: np.ndarray  # (n, 2): u_d, F_d
    use: np.ndarray  # (4, n, 2) ns: instant of use, stamp of the sample
    arrival: np.ndarray  # (n,) ns: instants at which the motor's command changed
    arrived: np.ndarray  # (n,) m: to what
    count: np.ndarray


@njit
def sample(
    t: int,
    row: np.ndarray,
    noise: np.ndarray,
    y: np.ndarray,
    memory: np.ndarray,
    held: Held,
    world: World,
    sensors: tuple[Sensor, ...],
) -> None:
    """Record the plant at t ns into `row`."""
    s = t * 1e-9
    u, F = wire_force(0.0, y, memory, held, world)
    w1 = load(s, world.load1)
    row[0] = read(s, y[X1], y[SEEN_X], noise[0], sensors[0])
    row[1] = read(s, y[V1], y[SEEN_V], noise[1], sensors[1])
    row[2] = read(s, u, u, noise[2], sensors[2])
    row[3] = read(s, F, y[SEEN_F], noise[3], sensors[3])
    row[4], row[5], row[6], row[7] = y[X1], y[V1], u, F
    row[W1] = w1
    plant = world.plant
    a1 = acceleration(s, pull(s, 0.0, y, memory, held, world), y[X1], y[V1], memory[MODE], plant)
    row[EXTRA_PLANT] = plant.mass * a1 + plant.damping * y[V1] + plant.stiffness * y[X1] - F - w1
    row[EXTRA_WIRE] = F - world.wire.stiffness * (u - y[X1])


@njit
def jump(t: int, command: float, y: np.ndarray, memory: np.ndarray, held: Held, world: World) -> Held:
    """Give the motor a new command at t ns."""
    held = Held(accepted(t * 1e-9, command, world.motor), held.x1, held.v1)
    remember(0.0, y, memory, held, world)
    settle(t * 1e-9, y, memory, held, world)
    return held


@njit
def note(which: int, t: int, stamp: int, log: Recording) -> None:
    """Record that link `which` delivered the sample of `stamp` for use at t."""
    i = log.count[2 + which]
    log.use[which, i, 0] = t
    log.use[which, i, 1] = stamp
    log.count[2 + which] = i + 1


@kept
def closed_loop(
    y: np.ndarray,
    memory: np.ndarray,
    held: Held,
    F_d: float,
    k_tot: float,
    ahead: Foresight,
    world: World,
    sensors: tuple[Sensor, ...],
    timing: Timing,
    links: tuple[Link, ...],
    noise: np.ndarray,
    step: float,
    log: Recording,
) -> None:
    """Run the test and fill `log`.

    `y`, `memory`, `held` (initial z1 for the numerical side, initial command) and `F_d` are what has been for
    ever; `k_tot` is what the controller divides by, `ahead` its compensator; `noise` is (n1, 4) of standard
    normal numbers; `step` the longest step of the integration in s.
    """
    link1, link2, link3, link4 = links
    work = np.zeros((6, y.size))
    slots = foresight.latched(held.x1, held.v1, F_d, timing.td1, timing.td2)
    used = F_d
    now = n1 = n2 = n3 = n4 = 0
    while True:
        soonest = min(next_due(link1), next_due(link2), next_due(link3), next_due(link4))
        t = min(n1 * timing.td1, n2 * timing.td2, n3 * timing.td3, soonest)
        if t > timing.duration:
            break
        advance(now * 1e-9, (t - now) * 1e-9, step, y, memory, held, world, work)
        now = t
        # (1) delays that are over
        if deliver(t, link4):
            held = jump(t, log.command[link4.span[2], 0], y, memory, held, world)
            n4 = arrive(t, log.command[link4.span[2], 0], log.command_stamp[link4.span[2]], timing, n4, log)
        deliver(t, link1)
        deliver(t, link2)
        fresh = deliver(t, link3)
        # (2) data acquisition
        if t == n1 * timing.td1:
            sample(t, log.plant[n1], noise[n1], y, memory, held, world, sensors)
            n1 += 1
            send(t, link1)
            send(t, link2)
            deliver(t, link1)
            deliver(t, link2)
        # (3) numerical substructure
        if t == n2 * timing.td2:
            i = link2.span[2]
            if i >= 0:
                held = Held(held.command, log.plant[i, 0], log.plant[i, 1])
                note(1, t, i * timing.td1, log)
            w2 = load(t * 1e-9, world.load2)
            F_c = interface_force(held.x1, held.v1, y, world.numerical)
            log.numerical[n2] = np.array([y[X2], y[V2], w2, F_c])
            n2 += 1
            send(t, link3)
            fresh = deliver(t, link3) or fresh
        if fresh:
            used = log.numerical[link3.span[2], 3]
            foresight.latch(slots, foresight.F_D, used, link3.span[2] * timing.td2)
            note(2, t, link3.span[2] * timing.td2, log)
        # (4) controller
        tick = t == n3 * timing.td3
        if tick:
            n3 += 1
            if link1.span[2] >= 0:
                i1 = link1.span[2]
                slots[foresight.X1] = log.plant[i1, 0]
                foresight.latch(slots, foresight.V1, log.plant[i1, 1], i1 * timing.td1)
                note(0, t, link1.span[2] * timing.td1, log)
        if tick or fresh:
            i = log.count[1]
            log.command_stamp[i] = t
            log.command[i, 0] = foresight.command(slots, k_tot, ahead)
            log.command[i, 1] = used
            log.count[1] = i + 1
            send(t, link4)
            if deliver(t, link4):
                held = jump(t, log.command[i, 0], y, memory, held, world)
                n4 = arrive(t, log.command[i, 0], t, timing, n4, log)
    log.count[0] = n2


@njit
def arrive(t: int, command: float, stamp: int, timing: Timing, n4: int, log: Recording) -> int:
    """Record a command that reached the motor; the link's own instant is before the motor's extra delay."""
    note(3, t - timing.motor_delay, stamp, log)
    log.arrival[n4] = t
    log.arrived[n4] = command
    return n4 + 1


@kept
def plant_alone(
    y: np.ndarray,
    memory: np.ndarray,
    held: Held,
    world: World,
    arrival: np.ndarray,
    arrived: np.ndarray,
    td1: int,
    step: float,
    out: np.ndarray,
) -> None:
    """x1, v1, u, F at every td1 ns into `out` (n1, 4), driven by the commands that reached the motor."""
    work = np.zeros((6, y.size))
    now = n1 = n4 = 0
    while n1 < out.shape[0]:
        due = arrival[n4] if n4 < arrival.size else NEVER
        t = min(n1 * td1, due)
        advance(now * 1e-9, (t - now) * 1e-9, step, y, memory, held, world, work)
        now = t
        if t == due:
            held = jump(t, arrived[n4], y, memory, held, world)
            n4 += 1
        if t == n1 * td1:
            u, F = wire_force(0.0, y, memory, held, world)
            out[n1, 0], out[n1, 1], out[n1, 2], out[n1, 3] = y[X1], y[V1], u, F
            n1 += 1
