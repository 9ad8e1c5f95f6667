"""The loop of the contract once more, by brute force: a fixed step of 1e-5 s and every held and delayed
signal as a literal array.

Shares nothing with the engine but the matrices that a test hands to both.
"""

from __future__ import annotations

import numba
import numpy as np

STEP_NS = 10_000


@numba.njit
def _acceleration1(y, u, b, out):
    n = b[0].shape[0]
    inverse_mass, damping, stiffness, dof, k_tot, cubic, drag = b
    force = np.zeros(n)
    for i in range(n):
        for j in range(n):
            force[i] -= stiffness[i, j] * y[j] + damping[i, j] * y[n + j]
        force[i] -= cubic[i] * y[i] ** 3 + drag[i] * abs(y[n + i]) * y[n + i]
    for a in range(u.size):
        force[dof[a]] += k_tot[a] * (u[a] - y[dof[a]])
    for i in range(n):
        out[i] = y[n + i]
        out[n + i] = 0.0
        for j in range(n):
            out[n + i] += inverse_mass[i, j] * force[j]


@numba.njit
def _acceleration2(y, held, b, out):
    n = b[0].shape[0]
    inverse_mass, damping, stiffness, dof, k, c = b
    m = k.size
    force = np.zeros(n)
    for i in range(n):
        for j in range(n):
            force[i] -= stiffness[i, j] * y[j] + damping[i, j] * y[n + j]
    for a in range(m):
        force[dof[a]] += k[a] * (held[a] - y[dof[a]]) + c[a] * (held[m + a] - y[n + dof[a]])
    for i in range(n):
        out[i] = y[n + i]
        out[n + i] = 0.0
        for j in range(n):
            out[n + i] += inverse_mass[i, j] * force[j]


@numba.njit
def _runge_kutta(right, y, held, b, h):
    k1, k2, k3, k4 = np.empty_like(y), np.empty_like(y), np.empty_like(y), np.empty_like(y)
    right(y, held, b, k1)
    right(y + 0.5 * h * k1, held, b, k2)
    right(y + 0.5 * h * k2, held, b, k3)
    right(y + h * k3, held, b, k4)
    return y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@numba.njit
def _past(signal, i, initial):
    return signal[i] if i >= 0 else initial


@numba.njit
def simulate(y1, y2, b1, b2, steps, td, tau):
    """States of both sides at every step; `td` and `tau` in steps, td[3] = 0."""
    dof1, k_tot, dof2, k, c = b1[3], b1[4], b2[3], b2[4], b2[5]
    m, n1, n2 = k_tot.size, y1.size // 2, y2.size // 2
    first = np.empty(2 * m)
    first_force = np.empty(m)
    for a in range(m):
        first[a], first[m + a] = y1[dof1[a]], y1[n1 + dof1[a]]
        first_force[a] = -c[a] * (first[m + a] - y2[n2 + dof2[a]]) - k[a] * (first[a] - y2[dof2[a]])
    sampled, reference, command = np.empty((steps, 2 * m)), np.empty((steps, m)), np.empty((steps, m))
    out1, out2 = np.empty((steps, y1.size)), np.empty((steps, y2.size))
    held, cancelled = first.copy(), first[:m].copy()
    for i in range(steps):
        out1[i], out2[i] = y1, y2
        sampled[i] = sampled[i - 1] if i else first
        if i % td[0] == 0:
            for a in range(m):
                sampled[i, a], sampled[i, m + a] = y1[dof1[a]], y1[n1 + dof1[a]]
        reference[i] = reference[i - 1] if i else first_force
        if i % td[1] == 0:
            held = _past(sampled, i - tau[1], first).copy()
            for a in range(m):
                reference[i, a] = -c[a] * (held[m + a] - y2[n2 + dof2[a]]) - k[a] * (held[a] - y2[dof2[a]])
        if i % td[2] == 0:
            cancelled = _past(sampled, i - tau[0], first)[:m].copy()
        command[i] = cancelled + _past(reference, i - tau[2], first_force) / k_tot
        u = _past(command, i - tau[3], first[:m] + first_force / k_tot)
        y1 = _runge_kutta(_acceleration1, y1, u, b1, 1e-5)
        y2 = _runge_kutta(_acceleration2, y2, held, b2, 1e-5)
    return out1, out2


def brute_force(spec, duration, cubic=None, drag=None):
    """Motion [x1, v1] and [x2, v2] of a loop with h(s) = 1 at every step of 1e-5 s."""

    def square(values, n):
        return np.array(values, dtype=float).reshape(n, n)

    p, q, face, n1, n2 = (
        spec.plant,
        spec.numerical,
        spec.interface,
        len(spec.plant.dofs),
        len(spec.numerical.dofs),
    )
    dof1 = np.array([p.dofs.index(name) for name in face.plant_dof])
    dof2 = np.array([q.dofs.index(name) for name in face.numerical_dof])
    zero = np.zeros(n1)
    b1 = (
        np.linalg.inv(square(p.mass, n1)),
        square(p.damping, n1),
        square(p.stiffness, n1),
        dof1,
        np.array(spec.k_tot),
        zero if cubic is None else cubic,
        zero if drag is None else drag,
    )
    b2 = (
        np.linalg.inv(square(q.mass, n2)),
        square(q.damping, n2),
        square(q.stiffness, n2),
        dof2,
        np.array(face.stiffness),
        np.array(face.damping),
    )
    y1 = np.array([*p.initial_position, *p.initial_velocity], dtype=float)
    y2 = np.array([*q.initial_position, *q.initial_velocity], dtype=float)
    td = np.array([spec.timing.ns(name) // STEP_NS for name in ("td1", "td2", "td3")])
    tau = np.array([spec.timing.ns(name) // STEP_NS for name in ("tau1", "tau2", "tau3", "tau4")])
    return simulate(y1, y2, b1, b2, round(duration * 1e9) // STEP_NS + 1, td, tau)
