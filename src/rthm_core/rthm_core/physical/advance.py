"""Advance the physical side from one instant to another, and what can be seen of it there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place
from rthm_core.linear import step_linear
from rthm_core.loads import load_derivatives, smooth_until
from rthm_core.physical.drive import (
    LIMIT,
    QUANTUM,
    RATE,
    conditioned,
    motor_position,
    motor_velocity,
    settled,
)
from rthm_core.physical.flow import mechanics_rate, wire_force
from rthm_core.physical.integrate import POINT, SCRATCH, Trace, Work, integrate, trace, work
from rthm_core.physical.laws import DOF, POSITION, VELOCITY
from rthm_core.physical.model import PhysicalModel, Resting
from rthm_core.physical.sensors import measured


class PhysicalState(NamedTuple):
    """State of the physical side; arrays that the compiled code changes in place.

    Attributes
    ----------
    time : (1,) array
        Instant to which the state belongs, ns since the start of the test.
    whole : (nq + ny,) array
        Motor chain and mechanics; `q` and `y` are views of it.
    command, target : (m,) arrays
        Input of the motor chain, and where a rate-limited input is going, in m.
    modes : (L,) array
        Piece in force of every nonlinear law.
    step, scale
        Step and error scale of the integration.
    inputs : (orders, m + loads) array
        Derivatives of commands and loads at the start of the present segment.
    """

    time: Integers
    whole: Floats
    q: Floats
    y: Floats
    command: Floats
    target: Floats
    modes: Integers
    step: Floats
    scale: Floats
    inputs: Floats


class Physical(NamedTuple):
    """Model, state and scratch: what compiled code is handed as one."""

    model: PhysicalModel
    state: PhysicalState
    work: Work
    trace: Trace


def physical(
    model: PhysicalModel, resting: list[Resting], position: Floats, velocity: Floats, command: Floats
) -> Physical:
    """Physical side at the start of a test, in steady state: the motors at `command` (m,), the plant at
    `position` (n,).
    """
    nq, ny, laws, limit = (
        model.drive.system.ab.shape[0],
        model.mechanics.shape[0],
        mode_count(model),
        model.drive.conditioning[LIMIT],
    )
    whole = np.zeros(nq + ny)
    q, y = whole[:nq], whole[nq:]
    quantum = model.drive.conditioning[QUANTUM]
    steps = np.where(quantum > 0.0, quantum, 1.0)
    rounded = np.where(quantum > 0.0, steps * np.floor(command / steps + 0.5), command)
    first = np.clip(rounded, -limit, limit).astype(float)
    q[:] = settled(model.drive, first)
    y[: model.n], y[model.n : 2 * model.n] = position, velocity
    _rest(model, resting, y, model.drive.out @ np.concatenate([q, first]))
    inputs = np.zeros((model.whole.orders, model.whole.ab.shape[1] - nq - ny))
    state = PhysicalState(
        np.zeros(1, dtype=np.int64),
        whole,
        q,
        y,
        first.copy(),
        first.copy(),
        _first_modes(model, y),
        np.array([np.inf]),
        np.abs(y),
        inputs,
    )
    return Physical(model, state, work(ny, nq, model.m, model.load_dof.size, laws), trace(ny, laws))


def _rest(model: PhysicalModel, resting: list[Resting], y: Floats, u: Floats) -> None:
    """Own states of pulleys, laws and sensors in steady state at the initial position."""
    wires, sensors = model.wires, model.sensors
    for actuator, (dof, pulley, _) in enumerate(wires.numbers.tolist()):
        if pulley >= 0:
            k, nominal = wires.stiffness[actuator]
            soft = 1.0 / (1.0 / nominal - 1.0 / k)
            y[pulley] = (soft * u[actuator] + k * y[dof]) / (soft + k)
    for law, p, where, place, at in resting:
        if where == "plant":
            y[at : at + law.states] = law.initial(y[place], p)
        else:
            drive_position = wires.drive[place] @ np.concatenate([y, u])
            y[at : at + law.states] = law.initial(drive_position, y[wires.numbers[place, DOF]], p)
    for row in np.flatnonzero(sensors.lagged >= 0).tolist():
        actuator = row - 2 * model.n
        force = (
            wires.stiffness[actuator, 1] * (u[actuator] - y[wires.numbers[actuator, DOF]])
            if actuator >= 0
            else 0.0
        )
        y[sensors.lagged[row]] = y[row] if actuator < 0 else force


def mode_count(model: PhysicalModel) -> int:
    """Number of modes: one per law that is not linear, then one per wire (1: taut, -1: slack)."""
    return 0 if model.laws is None else int(model.laws.numbers.shape[0]) + model.m


def _first_modes(model: PhysicalModel, y: Floats) -> Integers:
    modes = np.zeros(mode_count(model), dtype=np.int64)
    if model.laws is None:
        return modes
    for row, (_, dof, _, _, partition) in enumerate(model.laws.numbers):
        x, v = y[dof], y[model.n + dof]
        if partition == POSITION:
            modes[row] = int(np.sum(model.laws.thresholds[row] < x))
        elif partition == VELOCITY:
            modes[row] = -1 if v < 0.0 else 1
        elif partition:
            modes[row] = int(np.sign(v))
    return modes


@called
def set_command(physical, command):  # type: ignore[no-untyped-def]
    """Give the motors a new command (m,); a rate limit is still to be travelled."""
    model, state = physical.model, physical.state
    conditioned(model.drive, command, state.target)
    for i in range(model.m):
        if model.drive.conditioning[RATE, i] == np.inf:
            state.command[i] = state.target[i]


@called
def _segment_end(physical, to_ns):  # type: ignore[no-untyped-def]
    """End of the longest segment over which commands and loads are polynomials, at most `to_ns`."""
    model, state = physical.model, physical.state
    now = state.time[0]
    end = smooth_until(model.loads, now, to_ns)
    for i in range(model.m):
        if state.command[i] != state.target[i]:
            travel = abs(state.target[i] - state.command[i]) / model.drive.conditioning[RATE, i]
            end = min(end, now + max(1, math.ceil(travel * 1e9)))
    return end


@called
def begin_segment(physical):  # type: ignore[no-untyped-def]
    """Write the derivatives of commands and loads at the present instant into ``state.inputs``."""
    model, state = physical.model, physical.state
    m = model.m
    for i in range(m):
        state.inputs[0, i] = state.command[i]
        if state.command[i] != state.target[i]:
            state.inputs[1, i] = math.copysign(
                model.drive.conditioning[RATE, i], state.target[i] - state.command[i]
            )
        elif state.inputs.shape[0] > 1:
            state.inputs[1, i] = 0.0
    load_derivatives(model.loads, state.time[0], m, state.inputs)


@called
def _finish_segment(physical, end, dt):  # type: ignore[no-untyped-def]
    model, state = physical.model, physical.state
    for i in range(model.m):
        if state.command[i] != state.target[i]:
            travelled = model.drive.conditioning[RATE, i] * dt
            left = state.target[i] - state.command[i]
            state.command[i] = (
                state.target[i]
                if abs(left) <= travelled
                else state.command[i] + math.copysign(travelled, left)
            )
    state.time[0] = end


@called
def _move(laws, model, physical, dt):  # type: ignore[no-untyped-def]
    """Move motor and mechanics by `dt`, within a segment that has begun."""
    state = physical.state
    if laws is None:
        step_linear(model.whole, state.whole, state.inputs, dt)
    else:
        integrate(model, state, physical.work, physical.trace, state.time[0] * 1e-9, dt)
        if state.q.size:
            step_linear(model.drive.system, state.q, state.inputs, dt)


@called
def advance_segment(physical, to_ns):  # type: ignore[no-untyped-def]
    """Advance to `to_ns` or to the end of the segment before it; the trace then holds its smooth steps if the
    mechanics are not linear.
    """
    model, state = physical.model, physical.state
    begin_segment(physical)
    end = _segment_end(physical, to_ns)
    dt = (end - state.time[0]) * 1e-9
    _move(model.laws, model, physical, dt)
    _finish_segment(physical, end, dt)


@called
def advance_physical(physical, to_ns):  # type: ignore[no-untyped-def]
    """Advance to an instant (ns since the start)."""
    while physical.state.time[0] < to_ns:
        advance_segment(physical, to_ns)


@called
def present_force(physical, out):  # type: ignore[no-untyped-def]
    """True wire forces (m,) now; ``work.u`` is left at the motor positions."""
    model, state, work = physical.model, physical.state, physical.work
    motor_position(model.drive, state.q, state.command, work.u)
    for actuator in range(model.m):
        out[actuator] = wire_force(
            model.laws,
            model.wires,
            model.n,
            state.y,
            work.u,
            actuator,
            work.rows[SCRATCH],
            work.rows[POINT],
            work.hold,
        )


@called
def sample_physical(physical, stamp, out):  # type: ignore[no-untyped-def]
    """Measure everything now: `out` gets n positions, n velocities, m forces, m motor positions, m motor
    velocities and n loads.
    """
    model, state, work = physical.model, physical.state, physical.work
    n, m = model.n, model.m
    present_force(physical, out[2 * n :])
    for row in range(2 * n):
        out[row] = measured(model.sensors, row, state.y[row], state.y, stamp)
    for actuator in range(m):
        row = 2 * n + actuator
        out[row] = measured(model.sensors, row, out[row], state.y, stamp)
        out[row + m] = measured(model.sensors, row + m, work.u[actuator], state.y, stamp)
    motor_velocity(model.drive, state.q, state.command, out[2 * n + 2 * m : 2 * n + 3 * m])
    listed_loads(physical, out[2 * n + 3 * m :])


@called
def listed_loads(physical, out):  # type: ignore[no-untyped-def]
    """Known external forces (n,) now; hidden loads are not among them."""
    model, state = physical.model, physical.state
    load_derivatives(model.loads, state.time[0], model.m, state.inputs)
    for i in range(out.size):
        out[i] = 0.0
    for i in range(model.listed_loads):
        out[model.load_dof[i]] += state.inputs[0, model.m + i]


@called
def present_rate(physical, dy):  # type: ignore[no-untyped-def]
    """Time derivative (ny,) of the mechanics now."""
    model, state, work = physical.model, physical.state, physical.work
    begin_segment(physical)
    motor_position(model.drive, state.q, state.command, work.u)
    for i in range(work.w.size):
        work.w[i] = state.inputs[0, model.m + i]
    mechanics_rate(
        model.laws,
        model,
        state.modes,
        state.y,
        work.u,
        work.w,
        state.time[0] * 1e-9,
        dy,
        work.hold,
        work.rows[SCRATCH],
    )


@compiled_in_place
def advance_to(physical: Physical, to_ns: int) -> None:
    """Advance to an instant (compiled face)."""
    advance_physical(physical, to_ns)


@compiled_in_place
def command_and_advance(physical: Physical, at_ns: int, command: Floats) -> None:
    """Advance to an instant and give the motors a command there (compiled face)."""
    advance_physical(physical, at_ns)
    set_command(physical, command)


@compiled_in_place
def advance_and_sample(physical: Physical, stamp: int, out: Floats) -> None:
    """Advance to an instant and measure everything there (compiled face)."""
    advance_physical(physical, stamp)
    sample_physical(physical, stamp, out)
