"""The ledger of a simulation: work of all terms, added up step by smooth step."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, copy_into
from rthm_core.energy import (
    GAUSS_NODES,
    GAUSS_WEIGHTS,
    Bodies,
    Moment,
    bodies,
    cubic,
    moment,
    powers,
    quintic,
)
from rthm_core.linear import polynomial, step_linear
from rthm_core.loads import smooth_until
from rthm_core.numerical import Numerical, advance_numerical, begin_numerical
from rthm_core.physical.advance import Physical, advance_segment, present_rate
from rthm_core.physical.drive import Drive, drive, motor_position, settled
from rthm_core.physical.flow import mechanics_rate
from rthm_core.physical.integrate import SCRATCH, inputs_at
from rthm_core.physical.model import PhysicalModel
from rthm_core.physical.start import mode_count

if TYPE_CHECKING:
    from rthm_core.spec import Spec


SMOOTH, SMOOTH_OWN = 0.5, (0.02, 0.1)
"""Longest step in radians of the fastest motion; of mechanics with states of their own, which cubics
interpolate, and then of motors and the other side."""

LONGEST_BENT = 50_000
"""Longest step, ns, where a wire remembers its path: its force bends at places that nobody locates."""


class Ledger(NamedTuple):
    """Work so far, and the motors as the controller believes in them, once for each part of the commands.

    Attributes
    ----------
    on : bool
        Whether work is counted at all.
    work : (6,) array
        Work in J in the order of ``energy.TERMS``.
    believed : Drive
        h(s) alone.
    q_fx, q_ff, fx, ff : arrays
        Its chain states and present inputs for the two parts.
    longest : int
        Longest step, in ns, over which the interpolation between its ends is exact to rounding.
    """

    on: bool
    bodies: Bodies
    work: Floats
    believed: Drive
    q_fx: Floats
    q_ff: Floats
    fx: Floats
    ff: Floats
    longest: int
    at: Moment
    power: Floats
    y: Floats
    dy: Floats
    y_begin: Floats
    dy_begin: Floats
    q_begin: Floats
    inputs: Floats
    inputs2: Floats
    start2: Floats
    numerical: Floats
    used: Floats
    parts: Floats
    plain: bool
    hold: Floats
    modes: Integers


def ledger(
    spec: Spec, physical: Physical, numerical: Numerical, first_fx: Floats, first_ff: Floats, *, on: bool
) -> Ledger:
    """Empty ledger; `first_fx` and `first_ff` (m,) are the parts of the command that has been there for
    ever.
    """
    model = physical.model
    believed = drive(spec, model.whole.orders, effects=False)
    n1, n2, m, ny = model.n, numerical.n, model.m, model.mechanics.shape[0]
    mechanics, *others = (
        float(np.abs(np.linalg.eigvals(a)).max(initial=0.0))
        for a in (model.mechanics[:, :ny], numerical.system.a, model.drive.system.a, believed.system.a)
    )
    of_mechanics, of_others = (SMOOTH, SMOOTH) if ny == 2 * n1 else SMOOTH_OWN
    longest = int(1e9 / max(mechanics / of_mechanics, *(one / of_others for one in others), 1.0))
    longest = min(longest, LONGEST_BENT) if model.wires.paths.any() else longest
    plain = nothing_added(spec, model, believed)
    return Ledger(
        on,
        bodies(spec),
        np.zeros(6),
        believed,
        settled(believed, first_fx),
        settled(believed, first_ff),
        first_fx.copy(),
        first_ff.copy(),
        max(longest, 1000),
        moment(n1, n2, m),
        np.zeros(6),
        np.zeros(ny),
        np.zeros(ny),
        np.zeros(ny),
        np.zeros(ny),
        np.zeros(model.drive.system.ab.shape[0]),
        np.zeros_like(physical.state.inputs),
        np.zeros_like(numerical.inputs),
        np.zeros(2 * n2),
        np.zeros((4, 2 * n2)),
        np.zeros(believed.system.ab.shape[0]),
        np.zeros((model.whole.orders, m)),
        plain,
        np.zeros(mode_count(model)),
        np.zeros(mode_count(model), dtype=np.int64),
    )


def nothing_added(spec: Spec, model: PhysicalModel, believed: Drive) -> bool:
    """Whether nothing acts on the plant but what the controller believes in, so that E_effects is zero."""
    moved_by_commands = np.array_equal(believed.out, model.drive.out) and model.drive.takes_commands_as(
        believed
    )
    return (
        model.laws is None
        and moved_by_commands
        and model.mechanics.shape[0] == 2 * model.n
        and not any(e.block in ("plant", "wire") for e in spec.effects)
    )


@called
def _numerical_rate(numerical, y, inputs, s, dy):  # type: ignore[no-untyped-def]
    """Rate of the numerical state `y` a time `s` after the instant to which `inputs` belong."""
    ab = numerical.system.ab
    for i in range(y.size):
        rate = 0.0
        for j in range(y.size):
            rate += ab[i, j] * y[j]
        for j in range(inputs.shape[1]):
            rate += ab[i, y.size + j] * polynomial(inputs, j, 0, s)
        dy[i] = rate


@called
def _believed_position(ledger, q, part, s, out):  # type: ignore[no-untyped-def]
    """What h(s) has made of a part of the command a time `s` after the start of the segment."""
    copy_into(ledger.used, q)
    if q.size and s > 0.0:
        copy_into(ledger.parts[0], part)
        step_linear(ledger.believed.system, ledger.used, ledger.parts, s)
    motor_position(ledger.believed, ledger.used, part, out)


@called
def _plant_at(ledger, physical, y0, dy0, y1, dy1, h, r):  # type: ignore[no-untyped-def]
    """Mechanics at the fraction `r` of a smooth step, into ``ledger.y``."""
    n = physical.model.n
    y = ledger.y
    for i in range(n):
        y[i], y[n + i] = quintic(y0[i], y0[n + i], dy0[n + i], y1[i], y1[n + i], dy1[n + i], h, r)
        ledger.at.x1[i], ledger.at.v1[i] = y[i], y[n + i]
    for i in range(2 * n, y.size):
        settles = dy0[i] == 0.0 and dy1[i] == 0.0  # along the path from the start of the step
        y[i] = y0[i] if settles else cubic(y0[i], dy0[i], y1[i], dy1[i], h, r)


@called
def _outside(ledger, physical, modes, begin_ns, s):  # type: ignore[no-untyped-def]
    """Loads and everything that acts on the plant from outside, from the equation of motion, into
    ``ledger.at``.
    """
    model, work, at, b = physical.model, physical.work, ledger.at, ledger.bodies
    n = model.n
    inputs_at(model, work, ledger.q_begin, ledger.inputs, s)
    for i in range(n):
        at.w1[i] = 0.0
    for i in range(model.listed_loads):
        at.w1[model.load_dof[i]] += work.w[i]
    mechanics_rate(
        model.laws,
        model,
        modes,
        ledger.y,
        work.u,
        work.w,
        begin_ns * 1e-9 + s,
        ledger.dy,
        ledger.hold,
        work.rows[SCRATCH],
    )
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += b.m1[i, j] * ledger.dy[n + j] + b.c1[i, j] * ledger.y[n + j] + b.k1[i, j] * ledger.y[j]
        at.free[i] = total


@called
def _smooth_step(ledger, physical, numerical, begin_ns, s0, s1, y0, dy0, y1, dy1, modes, inputs2):  # type: ignore[no-untyped-def]
    """Add the work of one smooth step; ``ledger.numerical`` holds z2 and its rate at both ends."""
    at, h, two = ledger.at, s1 - s0, ledger.numerical
    n2 = numerical.n
    for node in range(4):
        r = GAUSS_NODES[node]
        s = s0 + r * h
        _plant_at(ledger, physical, y0, dy0, y1, dy1, h, r)
        for i in range(n2):
            at.x2[i], at.v2[i] = quintic(
                two[0, i], two[0, n2 + i], two[1, n2 + i], two[2, i], two[2, n2 + i], two[3, n2 + i], h, r
            )
        _outside(ledger, physical, modes, begin_ns, s)
        at.w2[numerical.load_dof[0]] = polynomial(inputs2, 2 * numerical.m, 0, s)
        _believed_position(ledger, ledger.q_fx, ledger.fx, s, at.u_fx)
        _believed_position(ledger, ledger.q_ff, ledger.ff, s, at.u_ff)
        powers(ledger.bodies, at, ledger.power)
        if ledger.plain:
            ledger.power[5] = 0.0
        for term in range(6):
            ledger.work[term] += h * GAUSS_WEIGHTS[node] * ledger.power[term]


@called
def _begin_counting(physical, numerical, ledger):  # type: ignore[no-untyped-def]
    """Note where a segment begins."""
    present_rate(physical, ledger.dy_begin)
    copy_into(ledger.y_begin, physical.state.y)
    copy_into(ledger.q_begin, physical.state.q)
    begin_numerical(numerical)
    for k in range(ledger.inputs.shape[0]):
        copy_into(ledger.inputs[k], physical.state.inputs[k])
    for k in range(ledger.inputs2.shape[0]):
        copy_into(ledger.inputs2[k], numerical.inputs[k])
    copy_into(ledger.start2, numerical.y)
    copy_into(ledger.numerical[0], numerical.y)
    _numerical_rate(numerical, ledger.numerical[0], ledger.inputs2, 0.0, ledger.numerical[1])


@called
def _numerical_end(numerical, ledger, s):  # type: ignore[no-untyped-def]
    """z2 and its rate a time `s` after the start of the segment, into rows 2 and 3 of
    ``ledger.numerical``.
    """
    copy_into(ledger.numerical[2], ledger.start2)
    step_linear(numerical.system, ledger.numerical[2], ledger.inputs2, s)
    _numerical_rate(numerical, ledger.numerical[2], ledger.inputs2, s, ledger.numerical[3])


@called
def _count_segment(physical, numerical, ledger, begin_ns, dt):  # type: ignore[no-untyped-def]
    """Add the work of a segment that has just been advanced, step by step."""
    trace = physical.trace
    if physical.model.laws is None:
        _one_step(physical, ledger, dt)
    for k in range(1, trace.count[0]):
        _numerical_end(numerical, ledger, trace.time[k])
        for i in range(ledger.modes.size):
            ledger.modes[i] = trace.modes[k, i]
        if trace.time[k] > trace.time[k - 1]:
            _smooth_step(
                ledger,
                physical,
                numerical,
                begin_ns,
                trace.time[k - 1],
                trace.time[k],
                trace.y[0, k - 1],
                trace.y[2, k],
                trace.y[0, k],
                trace.y[1, k],
                ledger.modes,
                ledger.inputs2,
            )
        copy_into(ledger.numerical[0], ledger.numerical[2])
        copy_into(ledger.numerical[1], ledger.numerical[3])


@called
def _one_step(physical, ledger, dt):  # type: ignore[no-untyped-def]
    """Write a segment of linear mechanics into the trace as one smooth step."""
    trace, work, state = physical.trace, physical.work, physical.state
    inputs_at(physical.model, work, ledger.q_begin, ledger.inputs, dt)
    copy_into(trace.y[0, 0], ledger.y_begin)
    copy_into(trace.y[2, 1], ledger.dy_begin)
    copy_into(trace.y[0, 1], state.y)
    mechanics_rate(
        physical.model.laws,
        physical.model,
        state.modes,
        state.y,
        work.u,
        work.w,
        0.0,
        trace.y[1, 1],
        ledger.hold,
        work.rows[SCRATCH],
    )
    trace.time[0], trace.time[1], trace.count[0] = 0.0, dt, 2


@called
def advance_counting(physical, numerical, ledger, to_ns):  # type: ignore[no-untyped-def]
    """Advance both sides to `to_ns` and count the work on the way."""
    state = physical.state
    copy_into(ledger.at.held, numerical.held)
    while state.time[0] < to_ns:
        begin_ns = state.time[0]
        _begin_counting(physical, numerical, ledger)
        advance_segment(
            physical, smooth_until(numerical.loads, begin_ns, min(to_ns, begin_ns + ledger.longest))
        )
        dt = (state.time[0] - begin_ns) * 1e-9
        advance_numerical(numerical, state.time[0])
        _count_segment(physical, numerical, ledger, begin_ns, dt)
        _advance_believed(ledger, dt)


@called
def _advance_believed(ledger, dt):  # type: ignore[no-untyped-def]
    if ledger.q_fx.size:
        copy_into(ledger.parts[0], ledger.fx)
        step_linear(ledger.believed.system, ledger.q_fx, ledger.parts, dt)
        copy_into(ledger.parts[0], ledger.ff)
        step_linear(ledger.believed.system, ledger.q_ff, ledger.parts, dt)
