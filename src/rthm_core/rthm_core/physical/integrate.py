"""Integration of mechanics that are not linear: Runge-Kutta 5(4) between switching points that are located
exactly.

A law's mode is frozen during a step. When a step would end in another mode, it is shortened until it ends
where the modes meet, and the law switches there.
No step crosses a kink, so that the order of the method holds through sticking, stops and turning points.

Method: Dormand and Prince (1980). The motor is not part of the integration: u is known exactly at every
stage.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, copy_into, inlined
from rthm_core.linear import polynomial, step_linear
from rthm_core.physical.drive import motor_position, motor_velocity
from rthm_core.physical.flow import mechanics_rate, product, settle_wires
from rthm_core.physical.laws import DOF, FRICTION, PARTITION, PLACE
from rthm_core.physical.switching import between, breakaway_mode, guard, keep_time, narrowed, next_mode

RELATIVE_ERROR = 1e-11
SMALLEST_SCALE = 1e-2
"""Error of a step, relative to the largest value that a state has had, and the least such value."""

_NODES = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_WEIGHTS = np.zeros((7, 6))
_WEIGHTS[1, :1] = [1 / 5]
_WEIGHTS[2, :2] = [3 / 40, 9 / 40]
_WEIGHTS[3, :3] = [44 / 45, -56 / 15, 32 / 9]
_WEIGHTS[4, :4] = [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729]
_WEIGHTS[5, :5] = [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656]
_WEIGHTS[6, :6] = [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]
_ERROR = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


class Trace(NamedTuple):
    """Smooth steps of one segment: row k > 0 is the end of step k, row 0 the start of the first.

    Attributes
    ----------
    count : (1,) array
        Number of rows.
    time : (rows,) array
        Seconds since the start of the segment.
    y : (3, rows, ny) array
        Mechanics and its rate at the end of each step, and its rate at the start of the step, after any
        switch there.
    modes : (rows, L) array
        Modes in force during the step that ends there.
    """

    count: Integers  # type: ignore[assignment]
    time: Floats
    y: Floats
    modes: Integers


class Work(NamedTuple):
    """Scratch of the integration: stages (7, ny), rows `TRIAL`, `POINT`, `SCRATCH`, `START` (4, ny), motor
    states, u and its rate, command, w, and what the guards of all modes look at: forces that hold, tensions
    of wires, rates of the paths that they remember.
    """

    stages: Floats
    rows: Floats
    q: Floats
    u: Floats
    du: Floats
    command: Floats
    w: Floats
    hold: Floats


TRIAL, POINT, SCRATCH, START = range(4)


def trace(size: int, laws: int, rows: int = 256) -> Trace:
    """Empty trace for a mechanics of `size` states."""
    return Trace(
        np.zeros(1, dtype=np.int64),
        np.zeros(rows),
        np.zeros((3, rows, size)),
        np.zeros((rows, laws), dtype=np.int64),
    )


def work(size: int, chain: int, m: int, loads: int, laws: int) -> Work:
    """Scratch for `size` mechanical and `chain` motor states, `m` actuators, `loads` loads and `laws`
    laws.
    """
    return Work(
        np.zeros((7, size)),
        np.zeros((4, size)),
        np.zeros(chain),
        np.zeros(m),
        np.zeros(m),
        np.zeros(m),
        np.zeros(loads),
        np.zeros(laws),
    )


@inlined
def inputs_at(model, work, q, inputs, s):  # type: ignore[no-untyped-def]
    """Motor positions and loads a time `s` after the start of the segment, into ``work.u`` and ``work.w``.

    `q` are the motor states at the start of the segment and `inputs` the derivatives of commands and loads
    there.
    """
    m = model.m
    copy_into(work.q, q)
    if q.size and s > 0.0:
        step_linear(model.drive.system, work.q, inputs, s)
    for i in range(m):
        work.command[i] = polynomial(inputs, i, 0, s)
    motor_position(model.drive, work.q, work.command, work.u)
    for i in range(work.w.size):
        work.w[i] = polynomial(inputs, m + i, 0, s)


@inlined
def rate(model, modes, work, y, t, dy):  # type: ignore[no-untyped-def]
    """Rate `dy` of a state at time `t` (s), with the motor positions and loads in `work`."""
    mechanics_rate(model.laws, model, modes, y, work.u, work.w, t, dy, work.hold, work.rows[SCRATCH])


@called
def _path_rates(model, work, inputs, y, dy, s):  # type: ignore[no-untyped-def]
    """Rates of the paths that laws of wires remember, into ``work.hold`` behind the tensions: the state `y`
    and its rate belong to a time `s` after the start of the segment, as what is in `work` does.
    """
    wires, first, chain = model.wires, model.laws.numbers.shape[0] + model.m, work.q.size
    motor_velocity(model.drive, work.q, work.command, work.du)
    for i in range(model.m):
        for k in range(model.m):
            work.du[i] += model.drive.out[i, chain + k] * polynomial(inputs, k, 1, s)
    for row in range(wires.laws.shape[0]):
        actuator = wires.laws[row, PLACE]
        drive_side, dof = (
            product(wires.drive[actuator], dy, work.du),
            y[model.n + wires.numbers[actuator, DOF]],
        )
        work.hold[first + row] = wires.paths[row, 0] * drive_side + wires.paths[row, 1] * dof


@called
def _try(model, state, work, t0, s, h):  # type: ignore[no-untyped-def]
    """One step of `h` from the present state, whose rate is in ``work.stages[0]``; its end goes to row
    `TRIAL`.
    """
    point, y = work.rows[POINT], state.y
    for stage in range(1, 7):
        for i in range(y.size):
            total = 0.0
            for j in range(stage):
                total += _WEIGHTS[stage, j] * work.stages[j, i]
            point[i] = y[i] + h * total
        if stage != 6:
            inputs_at(model, work, state.q, state.inputs, s + _NODES[stage] * h)
        rate(model, state.modes, work, point, t0 + s + _NODES[stage] * h, work.stages[stage])
    copy_into(work.rows[TRIAL], point)
    _path_rates(model, work, state.inputs, point, work.stages[6], s + h)


@inlined
def _error(work, scale, h):  # type: ignore[no-untyped-def]
    """Estimated error of the last trial over the allowed one."""
    worst = 0.0
    for i in range(scale.size):
        total = 0.0
        for j in range(7):
            total += _ERROR[j] * work.stages[j, i]
        worst = max(worst, abs(h * total) / (RELATIVE_ERROR * max(scale[i], SMALLEST_SCALE)))
    return worst


@inlined
def _guard(model, row, mode, y, hold):  # type: ignore[no-untyped-def]
    """How far a law is from leaving its mode; negative: it has left it."""
    if row >= model.laws.numbers.shape[0]:
        return mode * hold[row]
    return guard(model.laws, model.n, row, mode, y, hold[row])


@inlined
def _left(model, modes, y, hold, other_than, tolerance):  # type: ignore[no-untyped-def]
    """First law, other than one, that has left its mode by more than a tolerance; -1: none."""
    for row in range(modes.size):
        if row != other_than and _guard(model, row, modes[row], y, hold) < -tolerance:
            return row
    return -1


@called
def _locate(model, state, work, t0, s, h, row):  # type: ignore[no-untyped-def]
    """Length of the step that ends where law `row` leaves its mode (Illinois method); the trial is left
    there.
    """
    mode, trial = state.modes[row], work.rows[TRIAL]
    low, high, at_low = 0.0, h, 0.0
    at_high = _guard(model, row, mode, trial, work.hold)
    for _ in range(100):
        if high - low <= 1e-15 or high - low <= 1e-14 * h:
            break
        middle = between(low, high, at_low, at_high)
        _try(model, state, work, t0, s, middle)
        value = _guard(model, row, mode, trial, work.hold)
        low, high, at_low, at_high = narrowed(low, high, at_low, at_high, middle, value)
    _try(model, state, work, t0, s, high)
    return high


@inlined
def _switch(model, state, work, t, row):  # type: ignore[no-untyped-def]
    """Put law `row` into the mode that is in force from here on."""
    if row >= model.laws.numbers.shape[0]:
        state.modes[row] = -state.modes[row]
    else:
        state.modes[row] = next_mode(model.laws, model.n, row, state.modes[row], state.y, work.hold[row])


@called
def begin_step(model, state, work, t):  # type: ignore[no-untyped-def]
    """Rate at the start of a step, into ``work.stages[0]``; a dof that is held by more than its breakaway
    force comes loose first. Returns how long the step may be, in s, for laws that change with time.
    """
    longest = keep_time(model.laws, t, state.modes)
    for _ in range(2 * state.modes.size + 1):
        rate(model, state.modes, work, state.y, t, work.stages[0])
        loose = -1
        for row in range(model.laws.numbers.shape[0]):
            if (
                state.modes[row] == 0
                and model.laws.numbers[row, PARTITION] == FRICTION
                and abs(work.hold[row]) > model.laws.breakaway[row]
            ):
                loose = row
        if loose < 0:
            break
        state.modes[loose] = breakaway_mode(work.hold[loose])
    return longest


@inlined
def _record(trace, time, y, dy, start, modes):  # type: ignore[no-untyped-def]
    row = trace.count[0]
    if row < trace.time.size:
        trace.time[row] = time
        copy_into(trace.y[0, row], y)
        copy_into(trace.y[1, row], dy)
        copy_into(trace.y[2, row], start)
        for i in range(modes.size):
            trace.modes[row, i] = modes[i]
        trace.count[0] = row + 1


@inlined
def _until_switch(model, state, work, t0, s, h):  # type: ignore[no-untyped-def]
    """Shorten a step that was tried to the first switch on its way: its length, and the law that switches at
    its end (-1: none).
    """
    hold, trial = work.hold, work.rows[TRIAL]
    row = _left(model, state.modes, trial, hold, -1, 0.0)
    law = row
    while row >= 0:
        h = _locate(model, state, work, t0, s, h, row)
        law = row
        row = _left(model, state.modes, trial, hold, law, 1e-13)
    return h, law


@inlined
def _step_size(step, h, error):  # type: ignore[no-untyped-def]
    """Length to try next after a step of `h` with this relative error."""
    return max(step, h) if error == 0.0 else max(0.5 * step, h * min(4.0, 0.9 * error**-0.2))


@inlined
def _is_finite(y):  # type: ignore[no-untyped-def]
    finite = True
    for i in range(y.size):
        finite = finite and np.isfinite(y[i])
    return finite


@called
def integrate(model, state, work, trace, t0, dt):  # type: ignore[no-untyped-def]
    """Advance the mechanics ``state.y`` by `dt` seconds from time `t0` (s); the motor states in ``state.q``
    stay at its start. A motion that grew without bound is not a number from then on.
    """
    y, start, trial = state.y, work.rows[START], work.rows[TRIAL]
    inputs_at(model, work, state.q, state.inputs, 0.0)
    settle_wires(model.wires, y, work.u)
    longest = begin_step(model, state, work, t0)
    _path_rates(model, work, state.inputs, y, work.stages[0], 0.0)
    for row in range(model.laws.numbers.shape[0], state.modes.size):
        state.modes[row] = 1 if work.hold[row] >= 0.0 else -1
    trace.count[0] = 0
    _record(trace, 0.0, y, work.stages[0], work.stages[0], state.modes)
    s, still = 0.0, 0
    while s < dt and _is_finite(y):
        h = min(state.step[0], dt - s)
        if dt - s - h < 1e-3 * h:
            h = dt - s
        h = min(h, longest)
        _try(model, state, work, t0, s, h)
        error = _error(work, state.scale, h)
        if error > 1.0 and h > 1e-10:
            state.step[0] = h * max(0.2, 0.9 * error**-0.2)
            continue
        tried, law = h, -1
        if still < 20:
            h, law = _until_switch(model, state, work, t0, s, tried)
        s = dt if h == tried and dt - s <= h else s + h
        copy_into(start, work.stages[0])
        copy_into(y, trial)
        for i in range(y.size):
            state.scale[i] = max(state.scale[i], abs(y[i]))
        settle_wires(model.wires, y, work.u)
        _record(trace, s, y, work.stages[6], start, state.modes)
        if law >= 0:
            _switch(model, state, work, t0 + s, law)
            still = still + 1 if h < 1e-9 else 0
        else:
            still = 0
            state.step[0] = _step_size(state.step[0], h, error)
        longest = begin_step(model, state, work, t0 + s)
