"""What a motion contains of one complex exponential over a cycle.

The motion between the events is never sampled. If ``r(t) = y(t) e^{-st}`` repeats itself, the mean of
``dr/dt = (A - s) r + B u e^{-st}`` over a cycle is zero, so the component of y follows from that of the
staircase u alone: ``Y = (s - A)^{-1} B U``.
"""

from __future__ import annotations

import numpy as np

from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.walk import Forcing, walk
from rthm_core.compiled import Floats
from rthm_core.schedule import MOTOR, REFERENCE

Complex = np.ndarray
"""Array of complex numbers."""


def components(lifted: Lifted, states: Complex, s: Complex, forcing: Forcing | None = None) -> Complex:
    """Components (n1 + n2, L, S) of the positions x1, x2 at the exponents `s` (S,), 1/s.

    `states` (size, L) are lifted states that one cycle multiplies by ``e^{sT}``; under loads, what is
    returned is the part that the loop adds to the motion of the two sides alone.
    """
    loop, cycle, m = lifted.loop, lifted.cycle, lifted.loop.actuators
    columns = lifted.columns(np.ascontiguousarray(states, dtype=complex))
    count = states.shape[1]
    first = columns.u.copy()
    trace = np.zeros((cycle.time.size, 2 * m, count), dtype=complex)
    none = np.zeros((0, 2 * m, count), dtype=complex)
    sample, held = (none, none[:, :m]) if forcing is None else (forcing.sample, forcing.reference)
    walk(lifted.plan, columns, Forcing(sample, held, trace))
    motor, reference = cycle.what == MOTOR, cycle.what == REFERENCE
    u = _staircase(cycle.time[motor], np.concatenate([first[None], trace[motor, :m]]), lifted, s)
    h = _staircase(cycle.time[reference], np.concatenate([0.0 * trace[:1], trace[reference]]), lifted, s)
    one = [loop.position1 @ np.linalg.solve(_shifted(loop.a1, at), loop.b1 @ u[k]) for k, at in enumerate(s)]
    two = [loop.position2 @ np.linalg.solve(_shifted(loop.a2, at), loop.b2 @ h[k]) for k, at in enumerate(s)]
    return np.concatenate([np.stack(one, axis=-1), np.stack(two, axis=-1)])


def _shifted(a: Floats, s: complex) -> Complex:
    return s * np.eye(a.shape[0]) - a


def _staircase(time: Floats, values: Complex, lifted: Lifted, s: Complex) -> Complex:
    """Components (S, rows, L) of a staircase that has ``values[0]`` until ``time[0]``, and so on."""
    ends = np.concatenate([[0], time, [lifted.cycle.duration]]) * lifted.cycle.unit
    middle, half = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
    weights = np.exp(-s[:, None] * middle) * _sinhc(s[:, None] * half) * 2.0 * half
    return np.asarray(np.einsum("st,trc->src", weights, values) / lifted.cycle.hyperperiod)


def _sinhc(x: Complex) -> Complex:
    """sinh(x) / x."""
    small = np.abs(x) < 1e-3
    safe = np.where(small, 1.0, x)
    return np.where(small, 1.0 + x**2 / 6.0 + x**4 / 120.0, np.sinh(safe) / safe)
