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

BEGIN = 1_700_000_000 * NS
BESIDE = {"cost": 0.05, "report": None}


def messages(spec: Spec, duration: float) -> Iterator[tuple[str, int, bytes]]:
    """Topic, stamp (ns after the start) and bytes of what a test publishes, on a grid of 2 ms."""
    loop, run = spec.loop(), simulate(spec, duration, 0.002)
    names = loop.actuator.names
    plant = JointStateWriter((*loop.plant.dofs, *names)).bytes
    numerical = JointStateWriter(loop.numerical.dofs).bytes
    forces = JointStateWriter(names, ["effort"]).bytes
    commands = JointStateWriter(names, ["position", "effort"]).bytes
    terms = [*run.all_energies()]
    energy = JointStateWriter(terms, ["effort"]).bytes
    motor = run.plant_position + run.actuator_force / np.array(spec.k_tot)
    for k, t in enumerate(run.t):
        at = round(t * NS)
        x1, v1, x2, v2, u = (
            values[k]
            for values in (
                run.plant_position,
                run.plant_velocity,
                run.numerical_position,
                run.numerical_velocity,
                motor,
            )
        )
        loads = [0.0] * len(x1)
        yield (
            "plant/state",
            at,
            plant(
                BEGIN + at,
                np.concatenate([x1, u]),
                np.concatenate([v1, u * np.nan]),
                np.concatenate([loads, run.actuator_force[k]]),
            ),
        )
        yield "actuator/command", at, commands(BEGIN + at, u, run.force_reference[k])
        if k % 6 == 0:
            yield "numerical/state", at, numerical(BEGIN + at, x2, v2, x2 * 0.0)
            yield "numerical/force_reference", at, forces(BEGIN + at, run.force_reference[k])
        for link in ("tau1", "tau2", "tau3", "tau4"):
            used = at - loop.timing.ns(link)
            yield f"links/{link}", at, TimeReferenceWriter(link).bytes(BEGIN + at, BEGIN + used)
        if k % 50 == 0:
            yield "energy", at, energy(BEGIN + at, [run.all_energies()[term][k] for term in terms])


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
