"""Advance the physical side from one instant to another, and what can be seen of it there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, inlined
from rthm_core.lent import lent
from rthm_core.linear import step_linear
from rthm_core.loads import load_derivatives, smooth_until
from rthm_core.physical.drive import RATE, conditioned, motor_position, motor_velocity
from rthm_core.physical.flow import mechanics_rate, wire_force
from rthm_core.physical.integrate import POINT, SCRATCH, Trace, Work, integrate
from rthm_core.physical.model import PhysicalModel
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
        Mode in force of every law that is not linear, then of every wire (1: taut, -1: slack), then of every
        law of a wire (1 or -1: which way its path goes).
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


@called
def set_command(physical, command):  # type: ignore[no-untyped-def]
    """Give the motors a new command (m,); a rate limit is still to be travelled."""
    model, state = physical.model, physical.state
    conditioned(model.drive, command, state.time[0] * 1e-9, state.target)
    for i in range(model.m):
        if model.drive.conditioning[RATE, i] == np.inf:
            state.command[i] = state.target[i]


@inlined
def _travels(state, i):  # type: ignore[no-untyped-def]
    """Whether a rate-limited input is on its way; one that is not a number goes nowhere."""
    return abs(state.target[i] - state.command[i]) > 0.0


@called
def _segment_end(physical, to_ns):  # type: ignore[no-untyped-def]
    """End of the longest segment over which commands and loads are polynomials, at most `to_ns`."""
    model, state = physical.model, physical.state
    now = state.time[0]
    end = smooth_until(model.loads, now, to_ns)
    for i in range(model.m):
        if _travels(state, i):
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
        if _travels(state, i):
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
        if _travels(state, i):
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
    advance_physical(lent(physical), to_ns)


@compiled_in_place
def command_and_advance(physical: Physical, at_ns: int, command: Floats) -> None:
    """Advance to an instant and give the motors a command there (compiled face)."""
    physical = lent(physical)
    advance_physical(physical, at_ns)
    set_command(physical, command)


@compiled_in_place
def advance_and_sample(physical: Physical, stamp: int, out: Floats) -> None:
    """Advance to an instant and measure everything there (compiled face)."""
    physical = lent(physical)
    advance_physical(physical, stamp)
    sample_physical(physical, stamp, out)
