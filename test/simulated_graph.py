"""A test for the dashboard without a graph: the messages of a simulation, as nodes would send them."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from rthm_analysis.dashboard import Facts, RunningTest
from rthm_bringup.dashboard.hub import Hub
from rthm_bringup.dashboard.server import Server
from rthm_core.clock import NS
from rthm_core.engine import simulate
from rthm_core.ros.messages import JointStateWriter, TimeReferenceWriter
from rthm_core.spec import Spec
from rthm_core.substructure import interface

BEGIN = 1_700_000_000 * NS
BESIDE = {"cost": 0.05, "report": None}


def messages(spec: Spec, duration: float) -> Iterator[tuple[str, int, bytes]]:
    """Topic, stamp (ns after the start) and bytes of what a test publishes, on a grid of 2 ms."""
    loop, run = spec.loop(), simulate(spec, duration, 0.002)
    names, energies = loop.actuator.names, run.all_energies()
    plant = JointStateWriter((*loop.plant.dofs, *names)).bytes
    numerical = JointStateWriter(loop.numerical.dofs).bytes
    forces = JointStateWriter(names, ["effort"]).bytes
    commands = JointStateWriter(names, ["position", "effort"]).bytes
    energy = JointStateWriter([*energies], ["effort"]).bytes
    motor = run.plant_position[:, interface(spec).plant] + run.actuator_force / np.array(spec.k_tot)
    unknown, no_load = np.full(len(names), np.nan), np.zeros(len(loop.plant.dofs))
    for k, t in enumerate(run.t):
        at = round(t * NS)
        stamp, F_d = BEGIN + at, run.force_reference[k]
        x1, x2 = np.append(run.plant_position[k], motor[k]), run.numerical_position[k]
        v1, v2 = np.append(run.plant_velocity[k], unknown), run.numerical_velocity[k]
        yield "plant/state", at, plant(stamp, x1, v1, np.append(no_load, run.actuator_force[k]))
        yield "actuator/command", at, commands(stamp, motor[k], F_d)
        if k % 6 == 0:
            yield "numerical/state", at, numerical(stamp, x2, v2, x2 * 0.0)
            yield "numerical/force_reference", at, forces(stamp, F_d)
        for link in ("tau1", "tau2", "tau3", "tau4"):
            yield f"links/{link}", at, TimeReferenceWriter(link).bytes(stamp, stamp - loop.timing.ns(link))
        if k % 50 == 0:
            yield "energy", at, energy(stamp, [values[k] for values in energies.values()])


def running(spec: Spec, hub: Hub, duration: float = 12.0) -> RunningTest:
    """A test that has run so long, shown by a hub."""
    test = RunningTest(spec)
    test.learn(Facts(BEGIN, duration=20.0))
    node = "/rthm/plant: loop"
    test.told.note_status(node, {"Td1 missed deadlines": "3", "tau4 late": "1", "tau4 lost": "0"})
    due = NS // 10
    for topic, at, message in messages(spec, duration):
        if at > due:
            hub.look(test, BESIDE)
            due += NS // 10
        test.take(topic, message)
    hub.look(test, BESIDE)
    return test


@contextmanager
def served(hub: Hub) -> Iterator[Server]:
    """The server of a dashboard."""
    server = Server(hub, 0)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield server
    finally:
        server.close()
