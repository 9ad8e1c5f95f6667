"""Exact step of a linear system ``dy/dt = A y + B u(t)`` over any interval.

The input is a polynomial in the time since the start of the step, given by its derivatives there, so that
held commands (order 0), ramps
(order 1) and harmonic loads (all orders) take the same way.

A step is the Taylor series of the solution, summed until it stops changing: exact to rounding for any
interval, matrix and defect of the matrix.
Clocks make the same few intervals come again and again, so the first ones met are kept as matrices; where
jitter makes every interval a new
one, the series itself is cheap.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called

INTERVALS_KEPT = 64
"""How many different intervals are kept as matrices."""


class LinearSystem(NamedTuple):
    """A system and the steps kept so far.

    Attributes
    ----------
    ab : (n, n + q) array
        ``[A, B]``: dynamics (1/s) and effect of the q inputs.
    orders : int
        Number of derivatives of the inputs that a step is given.
    fastest : float
        Spectral radius of A, 1/s; one series covers at most ``1 / fastest``.
    kept_for, kept, count
        Intervals (s), their matrices ``(n, n + orders q)``, and their number.
    work, unit_inputs, unit : (2, n), (orders, q), (n,) arrays
        Scratch.
    """

    ab: Floats
    orders: int
    fastest: float
    kept_for: Floats
    kept: Floats
    count: Integers  # type: ignore[assignment]
    work: Floats
    unit_inputs: Floats
    unit: Floats

    @property
    def a(self) -> Floats:
        """Dynamics (n, n)."""
        return self.ab[:, : self.ab.shape[0]]

    @property
    def b(self) -> Floats:
        """Effect of the inputs (n, q)."""
        return self.ab[:, self.ab.shape[0] :]


def linear_system(a: Floats, b: Floats, orders: int = 1) -> LinearSystem:
    """System ``dy/dt = a y + b u`` whose inputs are polynomials with `orders` coefficients."""
    n, q = b.shape
    return LinearSystem(
        np.ascontiguousarray(np.hstack([a, b]), dtype=float),
        orders,
        float(np.abs(np.linalg.eigvals(a)).max(initial=0.0)) if n else 0.0,
        np.zeros(INTERVALS_KEPT),
        np.zeros((INTERVALS_KEPT, n, n + orders * q)),
        np.zeros(1, dtype=np.int64),
        np.zeros((2, n)),
        np.zeros((orders, q)),
        np.zeros(n),
    )


@called
def polynomial(inputs, column, k, s):  # type: ignore[no-untyped-def]
    """Derivative k of an input a time `s` after the instant to which the derivatives `inputs` (orders, ...)
    belong.
    """
    value, factor = 0.0, 1.0
    for j in range(k, inputs.shape[0]):
        value += inputs[j, column] * factor
        factor *= s / (j - k + 1)
    return value


@called
def _series(system, y, inputs, begin, dt):  # type: ignore[no-untyped-def]
    """Sum the Taylor series of the solution over `dt`, in place; the step starts `begin` after the inputs'
    instant.
    """
    ab, work, n = system.ab, system.work, y.size
    for i in range(n):
        work[0, i] = y[i]
    settled = 0
    factor = 1.0
    for k in range(1, 200):
        largest = 0.0
        for i in range(n):
            rate = 0.0
            for j in range(n):
                rate += ab[i, j] * work[0, j]
            if k <= system.orders:
                for j in range(n, ab.shape[1]):
                    rate += ab[i, j] * polynomial(inputs, j - n, k - 1, begin) * factor
            work[1, i] = rate * dt / k
        factor *= dt / k
        for i in range(n):
            work[0, i] = work[1, i]
            y[i] += work[1, i]
            largest = max(largest, abs(work[1, i]) - 1e-18 * abs(y[i]))
        settled = settled + 1 if largest <= 1e-300 else 0
        if settled == 2 and k >= system.orders:
            return


@called
def _series_in_parts(system, y, inputs, dt):  # type: ignore[no-untyped-def]
    parts = max(1, math.ceil(system.fastest * dt))
    for part in range(parts):
        _series(system, y, inputs, dt * part / parts, dt / parts)


@called
def _keep(system, slot, dt):  # type: ignore[no-untyped-def]
    """Fill `slot` with the matrix of a step of `dt`, column by column."""
    n = system.ab.shape[0]
    q = system.ab.shape[1] - n
    inputs, y = system.unit_inputs, system.unit
    for column in range(n + system.orders * q):
        for i in range(n):
            y[i] = 1.0 if i == column else 0.0
        if column >= n:
            inputs[(column - n) // q, (column - n) % q] = 1.0
        _series_in_parts(system, y, inputs, dt)
        if column >= n:
            inputs[(column - n) // q, (column - n) % q] = 0.0
        for i in range(n):
            system.kept[slot, i, column] = y[i]
    system.kept_for[slot] = dt


@called
def step_linear(system, y, inputs, dt):  # type: ignore[no-untyped-def]
    """Advance `y` (n,) by `dt` seconds in place.

    ``inputs[k, j]`` is derivative k of input j at the start of the step; further columns belong to others.
    """
    slot, count = 0, system.count[0]
    while slot < count and system.kept_for[slot] != dt:
        slot += 1
    if slot == INTERVALS_KEPT:
        _series_in_parts(system, y, inputs, dt)
        return
    if slot == count:
        system.count[0] = count + 1
        _keep(system, slot, dt)
    n = y.size
    q = system.ab.shape[1] - n
    for i in range(n):
        system.work[0, i] = y[i]
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += system.kept[slot, i, j] * system.work[0, j]
        for k in range(system.orders):
            for j in range(q):
                total += system.kept[slot, i, n + k * q + j] * inputs[k, j]
        y[i] = total
