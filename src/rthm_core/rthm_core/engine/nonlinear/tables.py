"""Work over every length of a loop whose plant has laws that are not linear, and the energy at its end, as
forms of what describes the motion over it.
"""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.digits import work_over_digits
from rthm_core.engine.linear.ledger import LinearLedger, packed, work_and_energy, work_tables
from rthm_core.engine.nonlinear.loop import NonlinearLoop
from rthm_core.engine.nonlinear.steps import ORDERS
from rthm_core.exponential import rate_bound
from rthm_core.simd import simd_copy

NONE: Integers = np.zeros(0, dtype=np.int64)
"""No lengths over which the work alone is asked for."""


def tables_over(loop: NonlinearLoop, lengths_ns: Integers) -> Floats:
    """Tables (sets lengths, pairs, 8) of work and energy for every set of sticking dofs and length, of the
    products of what describes the motion; empty where work is not counted.
    """
    if not loop.forms.size:
        return np.empty((0, 0, 0))
    if not loop.nonlinear.steady:
        return simd_copy(
            np.concatenate([_of_polynomials(loop, one, lengths_ns) for one in loop.nonlinear.systems])
        )
    return simd_copy(np.concatenate([work_tables(one, NONE, lengths_ns) for one in _ledgers(loop)]))


def tables_over_digits(loop: NonlinearLoop) -> Floats:
    """Likewise for every digit of a length, the energy left out; empty too where forces change within one."""
    if not (loop.forms.size and loop.nonlinear.steady):
        return np.empty((0, 0, 0))
    return simd_copy(np.concatenate([work_over_digits(one)[:-1] for one in _ledgers(loop)]))


def _ledgers(loop: NonlinearLoop) -> list[LinearLedger]:
    """The loop as a linear one, for every set of sticking dofs."""
    size, d = loop.nonlinear.systems.shape[1:]
    return [
        LinearLedger(loop.linear, np.vstack([system, np.zeros((d - size, d))]), loop.forms)
        for system in loop.nonlinear.systems
    ]


def _of_polynomials(loop: NonlinearLoop, system: Floats, lengths_ns: Integers) -> Floats:
    """Tables of a set whose forces are polynomials in thirds of each length.

    Such a force is a state, whose rates are the further coefficients. Their unit of time is that of the
    system here, since beside fast ones every exponential would be in many parts.
    """
    size, d = system.shape
    g, whole = loop.nonlinear.weight.size, d + (ORDERS - 1) * loop.nonlinear.weight.size
    joint, forms = np.zeros((whole, whole)), np.zeros((loop.forms.shape[0], whole, whole))
    joint[:size, :d], forms[:, :d, :d] = system, loop.forms
    unit = 1.0 / rate_bound(np.vstack([system, np.zeros((d - size, d))]))
    for order in range(1, ORDERS):
        rows = d + (order - 2) * g + np.arange(g)
        joint[rows, rows + g] = order / unit
    work = work_and_energy(LinearLedger(loop.linear, joint, forms), NONE, lengths_ns)
    orders = np.concatenate([np.zeros(d - g), np.repeat(np.arange(ORDERS), g)])
    scale = (unit / (lengths_ns[:, None] * 1e-9 / 3.0)) ** orders
    return packed(work * scale[:, None, :, None] * scale[:, None, None, :])
