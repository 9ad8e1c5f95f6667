"""Run a test, or its plant alone under the commands of another's recording."""

from __future__ import annotations

import numpy as np
from benchmarks.concealed import states as s
from benchmarks.concealed import wire as wires
from benchmarks.concealed.foresight import make_foresight
from benchmarks.concealed.loop import Recording, Timing, closed_loop, plant_alone
from benchmarks.concealed.motion import Held, World
from benchmarks.concealed.motor import accepted, position
from benchmarks.concealed.numerical import interface_force
from benchmarks.concealed.world import (
    HybridTest,
    controller_stiffness,
    effects_of,
    make_links,
    make_sensors,
    make_world,
    motor_delay,
    ns,
)

STEP = 1e-4  # s, longest step of the integration


def at_rest(test: HybridTest, world: World) -> tuple[np.ndarray, np.ndarray, Held, float]:
    """States, memory, held values and F_d in steady state before the test."""
    spec = test.spec
    y, memory = np.zeros(s.STATES), np.zeros(s.MEMORY)
    for slots, part in (((s.X1, s.V1), "plant"), ((s.X2, s.V2), "numerical")):
        y[list(slots)] = [spec[part].get(f"initial_{k}", [0.0])[0] for k in ("position", "velocity")]
    x1, v1 = y[s.X1], y[s.V1]
    F_d = interface_force(x1, v1, y, world.numerical)
    command = accepted(0.0, x1 + F_d / controller_stiffness(spec), world.motor)
    y[[s.POLE_V, s.POLE_A, s.LAG, s.SECOND]] = command
    y[[s.RELAX, s.HUNG]] = x1
    u = position(command, y, world.motor)
    wire = world.wire
    y[s.WIRE_RELAX] = u - x1
    y[s.PULLEY] = (wire.motor_side * u + wire.plant_side * x1) / (wire.motor_side + wire.plant_side)
    memory[:] = command, u, 0.5 * (u + x1), u - x1, 0.0, np.sign(v1)
    y[[s.SEEN_X, s.SEEN_V]] = x1, v1
    y[s.SEEN_F] = wires.force(u, y, memory, wire)
    return y, memory, Held(command, x1, v1), F_d


def run(
    test: HybridTest,
    duration: float,
    seed: int,
    noisy: bool = True,
    lateness: float = 0.0,
    step: float = STEP,
    noise: np.ndarray | None = None,
) -> Recording:
    """Run a test and return what every topic shows; `noise` in units of the reference, white by default."""
    rng = np.random.default_rng(seed)
    td1, td2, td3 = (ns(test.spec["timing"][k]) for k in ("td1", "td2", "td3"))
    timing = Timing(td1, td2, td3, ns(motor_delay(test.spec)), ns(duration))
    n1, n2, n3 = (timing.duration // td + 1 for td in (td1, td2, td3))
    many = n2 + n3
    count = np.zeros(6, dtype=np.int64)
    stamps = np.zeros(many, dtype=np.int64)
    uses = np.zeros((4, max(many, n1), 2), dtype=np.int64)
    log = Recording(
        np.zeros((n1, 11)),
        np.zeros((n2, 4)),
        stamps,
        np.zeros((many, 2)),
        uses,
        stamps.copy(),
        np.zeros(many),
        count,
    )
    world = make_world(test, duration)
    links = make_links(test.spec, (n1, n1, n2, many), rng, lateness)
    white = rng.normal(size=(n1, 4))
    sensors = make_sensors(test.spec, noisy)
    y, memory, held, F_d = at_rest(test, world)
    closed_loop(
        y,
        memory,
        held,
        F_d,
        controller_stiffness(test.spec),
        make_foresight(test.spec),
        world,
        sensors,
        timing,
        links,
        white if noise is None else noise,
        step,
        log,
    )
    for i in range(4):  # stamps as the receiver reads them
        uses[i, :, 1] += ns(
            sum(float(e["offset"]) for e in effects_of(test.spec, f"link.tau{i + 1}", "clock_offset"))
        )
    n_u, used = log.count[1], log.count[2:]
    return log._replace(
        command_stamp=stamps[:n_u],
        command=log.command[:n_u],
        use=uses,
        arrival=log.arrival[: used[3]],
        arrived=log.arrived[: used[3]],
    )


def replay(test: HybridTest, log: Recording, earlier: float = 0.0, step: float = STEP) -> np.ndarray:
    """x1, v1, u, F (n1, 4) of this plant under commands recorded elsewhere, `earlier` s before they came."""
    td1 = ns(test.spec["timing"]["td1"])
    world = make_world(test, len(log.plant) * td1 * 1e-9)
    y, memory, held, _ = at_rest(test, world)
    out = np.zeros((len(log.plant), 4))
    plant_alone(y, memory, held, world, log.arrival - ns(earlier), log.arrived, td1, step, out)
    return out
