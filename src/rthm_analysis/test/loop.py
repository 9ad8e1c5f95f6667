"""A hybrid test as its recorder would see it, made from the exact engine."""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd

import numpy as np

from rthm_analysis.energy.model import load_at
from rthm_core.chance import normal
from rthm_core.clock import to_ns
from rthm_core.controller import Controller
from rthm_core.link import NEVER
from rthm_core.schedule import Schedule, newest, overtaking
from rthm_core.spec import Spec
from rthm_core.substructure import interface

from .conftest import START, Message, joint_state, text, time_reference

NAN = float("nan")


@dataclass
class Stamps:
    """When everything happens in a test, ns after its start."""

    sample: np.ndarray
    tick: np.ndarray
    tick_state: np.ndarray
    command: np.ndarray
    command_state: np.ndarray
    command_reference: np.ndarray
    motor_use: np.ndarray
    motor_command: np.ndarray
    reference_use: np.ndarray
    reference_used: np.ndarray


def stamps(spec: Spec, duration: float) -> Stamps:
    """Exact stamps of a test."""
    schedule, end = Schedule(spec), to_ns(duration) + 1
    ticks, tick_state = schedule.references(0, end)
    commands = schedule.commands(0, end)
    due = schedule.links["tau4"].due_all(commands.time)
    used = overtaking(due)
    used = used[due[used] < end]
    reference_use, taken = _references_taken(schedule, ticks, end)
    return Stamps(
        schedule.ticks(schedule.td1, 0, end) * schedule.td1,
        ticks * schedule.td2,
        tick_state,
        commands.time,
        commands.state,
        commands.reference,
        due[used],
        commands.time[used],
        reference_use,
        taken * schedule.td2,
    )


def _references_taken(schedule: Schedule, numbers: np.ndarray, end: int) -> tuple[np.ndarray, np.ndarray]:
    """When the controller uses a reference, and its number; on a clock it tells so at each tick."""
    link = schedule.links["tau3"]
    if schedule.td4:
        ticks = schedule.ticks(schedule.td4, 0, end) * schedule.td4
        used = newest(link, schedule.td2, ticks)
        return ticks[used >= 0], used[used >= 0]
    due = link.due_all(numbers * schedule.td2)
    taken = overtaking(due)
    taken = taken[(due[taken] < end) & (due[taken] < NEVER)]
    return due[taken], numbers[taken]


def links(spec: Spec, when: Stamps, late: dict[str, np.ndarray] | None = None) -> list[Message]:
    """Messages of all links; `late` adds ns to the uses of a link."""
    schedule = Schedule(spec)
    regular = (when.command % schedule.td3 == 0) & (when.command_state >= 0)
    counted = when.tick_state >= 0
    uses = {
        "tau1": (when.command[regular], when.command_state[regular] * schedule.td1),
        "tau2": (when.tick[counted], when.tick_state[counted] * schedule.td1),
        "tau3": (when.reference_use, when.reference_used),
        "tau4": (when.motor_use, when.motor_command),
    }
    messages = []
    for name, (use, sample) in uses.items():
        shifted = use + (late or {}).get(name, np.zeros(1, dtype=np.int64))[: use.size]
        messages += [
            time_reference(f"/rthm/links/{name}", START + int(u), START + int(s), name)
            for u, s in zip(shifted, sample, strict=True)
        ]
    return messages


def empty_states(spec: Spec, when: Stamps) -> list[Message]:
    """States and commands with the right stamps and without motion, for tests of timing."""
    plant = [joint_state("/rthm/plant/state", START + int(t), ("x1", "a1"), (0, 0)) for t in when.sample]
    ticks = [joint_state("/rthm/numerical/state", START + int(t), ("x2",), (0,)) for t in when.tick]
    forces = [joint_state("/rthm/numerical/force_reference", START + int(t), ("a1",)) for t in when.tick]
    commands = [joint_state("/rthm/actuator/command", START + int(t), ("a1",), (0,)) for t in when.command]
    return [*plant, *ticks, *forces, *commands]


def recorded(spec: Spec, duration: float) -> list[Message]:
    """Everything that a recorder gets in a test of the exact engine, with the sensors' noise of the spec."""
    when, loop = stamps(spec, duration), spec.loop()
    schedule, sides = Schedule(spec), interface(spec)
    plant, numerical, force = _motion(spec, when, duration)
    held = _held(spec, plant, when.tick_state)
    reference = _reference(spec, held, numerical)
    u_d, at_use = _commands(spec, when, _held(spec, plant, when.command_state), reference)
    messages = [text("/rthm/spec", spec.expanded(), START)]
    n1, n2, m = len(loop.plant.dofs), len(loop.numerical.dofs), sides.actuators
    names = (*loop.plant.dofs, *loop.actuator.names)
    nothing = [NAN] * m
    loads = load_at(spec, when.sample)
    for t, row, w, f in zip(when.sample, plant, loads, force, strict=True):
        position, velocity = [*row[:n1], *nothing], [*row[n1:], *nothing]
        messages.append(joint_state("/rthm/plant/state", START + int(t), names, position, velocity, [*w, *f]))
    for t, row, f in zip(when.tick, numerical, reference, strict=True):
        at = START + int(t)
        messages.append(
            joint_state("/rthm/numerical/state", at, loop.numerical.dofs, row[:n2], row[n2:], [0.0] * n2)
        )
        messages.append(joint_state("/rthm/numerical/force_reference", at, loop.actuator.names, effort=f))
    for t, u, f in zip(when.command, u_d, at_use, strict=True):
        messages.append(
            joint_state("/rthm/actuator/command", START + int(t), loop.actuator.names, u, effort=f)
        )
    assert schedule.motor_delay == 0
    return messages + links(spec, when)


def _motion(spec: Spec, when: Stamps, duration: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Measured [x1, v1] at the samples, [x2, v2] at the ticks, and the true force at the samples."""
    from rthm_core.engine import simulate

    schedule = Schedule(spec)
    step = gcd(schedule.td1, schedule.td2)
    run = simulate(spec, duration, step * 1e-9, energies=False)
    at_sample, at_tick = when.sample // step, when.tick // step
    plant = np.hstack([run.plant_position, run.plant_velocity])[at_sample]
    channels = [(s, d) for s in ("position", "velocity") for d in spec.plant.dofs]
    for column, (sensor, dof) in enumerate(channels):
        if size := getattr(spec.noise, sensor):
            plant[:, column] += size * normal(int(spec.noise.seed), f"{sensor}.{dof}", when.sample)
    force = run.actuator_force[at_sample]
    if spec.noise.force:
        for column, name in enumerate(spec.actuator.names):
            force[:, column] += spec.noise.force * normal(int(spec.noise.seed), f"force.{name}", when.sample)
    return plant, np.hstack([run.numerical_position, run.numerical_velocity])[at_tick], force


def _held(spec: Spec, plant: np.ndarray, index: np.ndarray) -> np.ndarray:
    """[x1, v1] at the interface of the samples with these numbers; -1: the initial motion."""
    sides, n1 = interface(spec), len(spec.plant.dofs)
    columns = [*sides.plant, *(n1 + sides.plant)]
    first = np.array([*spec.plant.initial_position, *spec.plant.initial_velocity])
    return np.where(index[:, None] >= 0, plant[index], first)[:, columns]


def _reference(spec: Spec, held: np.ndarray, numerical: np.ndarray) -> np.ndarray:
    sides, n2, m = interface(spec), len(spec.numerical.dofs), len(spec.k_tot)
    x2, v2 = numerical[:, sides.numerical], numerical[:, n2 + sides.numerical]
    return -sides.damping * (held[:, m:] - v2) - sides.stiffness * (held[:, :m] - x2)


def _commands(
    spec: Spec, when: Stamps, held: np.ndarray, reference: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """u_d, and the F_d in it, at every command."""
    schedule, controller, m = Schedule(spec), Controller(spec), len(spec.k_tot)
    u_d, force = np.empty((when.command.size, m)), np.empty((when.command.size, m))
    for row, t in enumerate(when.command):
        state, number = when.command_state[row], when.command_reference[row]
        if state >= 0:
            controller.latch_state(int(state * schedule.td1), held[row, :m], held[row, m:])
        if number >= 0:
            controller.latch_force(int(number * schedule.td2), reference[number])
        u_d[row], force[row] = controller.command(int(t)), controller.force
    return u_d, force
