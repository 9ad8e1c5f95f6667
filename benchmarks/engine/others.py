"""What one would take instead, each as a call that gives x1 (N,) at the rows.

Every function takes (spec, duration in s, sample in s) and returns ``(call, of)``: `call` is timed, and `of`
of its result is the position of the plant. Compiling, where there is any, happens before.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE, Schedule
from rthm_core.spec import Spec

Entry = tuple[Callable[[], Any], Callable[[Any], Floats]]


def matrices(spec: Spec) -> tuple[Floats, Floats, Floats, Floats]:
    """Dynamics and input matrices of both sides: inputs u, and held [x1, v1]."""
    p, q, face = spec.plant, spec.numerical, spec.interface
    assert q is not None and face is not None
    m1, c1, k1, k_tot = p.mass[0], p.damping[0], p.stiffness[0], spec.k_tot[0]
    m2, c3, k3, c2, k2 = q.mass[0], q.damping[0], q.stiffness[0], face.damping[0], face.stiffness[0]
    one = np.array([[0.0, 1.0], [-(k1 + k_tot) / m1, -c1 / m1]])
    two = np.array([[0.0, 1.0], [-(k3 + k2) / m2, -(c3 + c2) / m2]])
    return one, np.array([[0.0], [k_tot / m1]]), two, np.array([[0.0, 0.0], [k2 / m2, c2 / m2]])


def start(spec: Spec) -> tuple[Floats, float]:
    """State [x1, v1, x2, v2] at the start, and the force in steady state."""
    p, q, face = spec.plant, spec.numerical, spec.interface
    assert q is not None and face is not None
    y = [p.initial_position[0], p.initial_velocity[0], q.initial_position[0], q.initial_velocity[0]]
    return np.array(y), -face.damping[0] * (y[1] - y[3]) - face.stiffness[0] * (y[0] - y[2])


def mean_delays(spec: Spec) -> tuple[float, float, float]:
    """Delays with half of every hold (20): x1 to the motor, z1 to the numerical side, F_d to the motor."""
    t = spec.loop().timing
    tau1, tau2 = t.tau1 + 0.5 * (t.td1 + t.td3), t.tau2 + 0.5 * (t.td1 + t.td2)
    return tau1 + t.tau4, tau2, t.tau3 + 0.5 * (t.td2 + t.td4) + t.tau4


def pade(spec: Spec, duration: float, sample: float, order: int = 4) -> Entry:
    """python-control: every delay, with half of its holds, as a Pade approximation."""
    import control

    one, b1, two, b2 = matrices(spec)
    y0, force = start(spec)
    face = spec.loop().interface
    k, c, k_tot = face.stiffness[0], face.damping[0], spec.k_tot[0]
    to_motor, to_numerical, back = mean_delays(spec)
    blocks = [
        control.tf2ss(*control.pade(delay, order)) for delay in (to_motor, to_numerical, to_numerical, back)
    ]
    n = 4 + sum(block.nstates for block in blocks)
    at = 4 + np.cumsum([0, *(block.nstates for block in blocks)])
    out = np.zeros((4, n))
    through = [float(block.D[0, 0]) for block in blocks]
    sources = np.zeros((4, n))
    sources[0, 0], sources[1, 0], sources[2, 1] = 1.0, 1.0, 1.0
    for i, block in enumerate(blocks[:3]):
        out[i, at[i] : at[i + 1]] = block.C[0]
        out[i] += through[i] * sources[i]
    sources[3] = -c * (out[2] - np.eye(n)[3]) - k * (out[1] - np.eye(n)[2])
    out[3, at[3] : at[4]] = blocks[3].C[0]
    out[3] += through[3] * sources[3]
    a = np.zeros((n, n))
    a[:2, :2], a[2:4, 2:4] = one, two
    a[:2] += b1 @ (out[:1] + out[3:] / k_tot)
    a[2:4] += b2 @ out[1:3]
    settled = [np.zeros(block.nstates) for block in blocks]
    for i, (block, value) in enumerate(zip(blocks, (y0[0], y0[0], y0[1], force), strict=True)):
        a[at[i] : at[i + 1], at[i] : at[i + 1]] = block.A
        a[at[i] : at[i + 1]] += block.B @ sources[i : i + 1]
        settled[i] = np.linalg.solve(block.A, -block.B[:, 0] * value)
    system = control.ss(a, np.zeros((n, 1)), np.eye(1, n), np.zeros((1, 1)))
    times = np.arange(to_ns(duration) // to_ns(sample) + 1) * sample
    begin = np.concatenate([y0, *settled])
    return lambda: control.initial_response(system, times, begin), lambda found: np.asarray(
        found.outputs
    ).ravel()


def runge_kutta(spec: Spec, duration: float, sample: float, h_ns: int = 100_000) -> Entry:
    """Fixed-step RK4 in numba; every held and delayed signal is looked up at every step."""
    one, b1, two, b2 = matrices(spec)
    y0, force = start(spec)
    face, t = spec.loop().interface, spec.loop().timing
    numbers = np.array([face.stiffness[0], face.damping[0], spec.k_tot[0], force])
    ticks = np.array([t.ns(x) // h_ns for x in ("td1", "td2", "td3", "tau1", "tau2", "tau3", "tau4")])
    steps, every = to_ns(duration) // h_ns, to_ns(sample) // h_ns
    arguments = (one, b1, two, b2, y0, numbers, ticks, steps, every, h_ns * 1e-9)
    _runge_kutta(*arguments)
    return lambda: _runge_kutta(*arguments), lambda rows: rows[:, 0]


@numba.njit  # type: ignore[untyped-decorator]
def _rate(a, b, y, held):  # type: ignore[no-untyped-def]
    dy0 = y[1]
    dy1 = a[1, 0] * y[0] + a[1, 1] * y[1]
    for j in range(held.size):
        dy1 += b[1, j] * held[j]
    return dy0, dy1


@numba.njit  # type: ignore[untyped-decorator]
def _step(a, b, y, held, h):  # type: ignore[no-untyped-def]
    z, k = np.empty(2), np.empty((4, 2))
    k[0, 0], k[0, 1] = _rate(a, b, y, held)
    for stage in range(1, 4):
        share = h if stage == 3 else 0.5 * h
        for i in range(2):
            z[i] = y[i] + share * k[stage - 1, i]
        k[stage, 0], k[stage, 1] = _rate(a, b, z, held)
    for i in range(2):
        y[i] += h / 6.0 * (k[0, i] + 2.0 * k[1, i] + 2.0 * k[2, i] + k[3, i])


@numba.njit  # type: ignore[untyped-decorator]
def _runge_kutta(one, b1, two, b2, y0, numbers, ticks, steps, every, h):  # type: ignore[no-untyped-def]
    td1, td2, td3, tau1, tau2, tau3, tau4 = ticks
    stiffness, damping, k_tot, first = numbers
    y1, y2 = y0[:2].copy(), y0[2:].copy()
    samples, references = np.empty((steps // td1 + 1, 2)), np.empty(steps // td2 + 1)
    commands, held, u = np.empty(steps + 1), y0[:2].copy(), np.empty(1)
    cancelled, rows = y0[0], np.empty((steps // every + 1, 4))
    for i in range(steps + 1):
        if i % td1 == 0:
            samples[i // td1] = y1
        if i % td2 == 0:
            held[:] = samples[(i - tau2) // td1] if i >= tau2 else y0[:2]
            references[i // td2] = -damping * (held[1] - y2[1]) - stiffness * (held[0] - y2[0])
        if i % td3 == 0:
            cancelled = samples[(i - tau1) // td1, 0] if i >= tau1 else y0[0]
        force = references[(i - tau3) // td2] if i >= tau3 else first
        commands[i] = cancelled + force / k_tot
        u[0] = commands[i - tau4] if i >= tau4 else y0[0] + first / k_tot
        if i % every == 0:
            rows[i // every, :2], rows[i // every, 2:] = y1, y2
        _step(one, b1, y1, u, h)
        _step(two, b2, y2, held, h)
    return rows


def restarted(spec: Spec, duration: float, sample: float) -> Entry:
    """Scipy's solve_ivp, restarted whenever an input changes; the event order is taken from the schedule."""
    from scipy.integrate import solve_ivp

    one, b1, two, b2 = matrices(spec)
    events = Schedule(spec).events(0, to_ns(duration) + 1, to_ns(sample))
    face, k_tot = spec.loop().interface, spec.k_tot[0]

    def right(_: float, y: Floats, u: float, held: tuple[float, float]) -> list[float]:
        return [
            y[1],
            one[1, 0] * y[0] + one[1, 1] * y[1] + b1[1, 0] * u,
            y[3],
            two[1, 0] * y[2] + two[1, 1] * y[3] + b2[1, 0] * held[0] + b2[1, 1] * held[1],
        ]

    def call() -> list[float]:
        y, force = start(spec)
        first, u, now = (float(y[0]), float(y[1])), float(y[0] + force / k_tot), 0
        held, samples, references, rows = first, {-1: first}, {-1: force}, []
        for time, what, index, state, reference in zip(*events, strict=True):
            if time > now and what in (SAMPLE, REFERENCE, MOTOR, OUTPUT):
                span = (0.0, (time - now) * 1e-9)
                y = solve_ivp(right, span, y, "RK45", args=(u, held), rtol=1e-10, atol=1e-12).y[:, -1]
                now = time
            if what == SAMPLE:
                samples[int(index)] = (y[0], y[1])
            elif what == REFERENCE:
                held = samples[int(state)]
                references[int(index)] = -face.damping[0] * (held[1] - y[3]) - face.stiffness[0] * (
                    held[0] - y[2]
                )
            elif what == MOTOR:
                u = samples[int(state)][0] + references[int(reference)] / k_tot
            elif what == OUTPUT:
                rows.append(float(y[0]))
        return rows

    return call, np.array
