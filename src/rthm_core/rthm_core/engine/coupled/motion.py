"""Motion of a system without a loop at the rows and at some instants after each of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, compiled_in_place, plainly
from rthm_core.engine.linear.loop import Exosystem, exosystem, with_loads
from rthm_core.engine.nonlinear.loop import alone
from rthm_core.engine.nonlinear.run import rows_alone
from rthm_core.exponential import exponentials
from rthm_core.lent import lent
from rthm_core.physical.advance import Physical, advance_physical, listed_loads, present_rate


class Motion(NamedTuple):
    """Positions, velocities, accelerations and known loads (rows, n) of all dofs."""

    x: Floats
    v: Floats
    a: Floats
    w: Floats

    def at(self, rows: slice) -> Motion:
        """Some of the rows."""
        return Motion(*(values[rows] for values in self))


@plainly
@compiled_in_place
def _follow(side: Physical, instants: Integers, rate: Floats, motion: Motion) -> None:
    """Motion at ascending instants in ns, by advancing to each; `rate` (ny,) is scratch."""
    side, n = lent(side), motion.x.shape[1]
    for row in range(instants.size):
        advance_physical(side, instants[row])
        present_rate(side, rate)
        for i in range(n):
            motion.x[row, i], motion.v[row, i] = side.state.y[i], side.state.y[n + i]
            motion.a[row, i] = rate[n + i]
        listed_loads(side, motion.w[row])


def _followed(side: Physical, instants: Integers) -> Motion:
    n = side.model.n
    motion = Motion(*(np.empty((instants.size, n)) for _ in range(4)))
    _follow(side, instants, np.empty(side.state.y.size), motion)
    return motion


BLOCK = 64
"""Rows of a linear system that are made of one."""


def _linear_motions(
    side: Physical, loads: Exosystem, count: int, step: int, offsets: Integers
) -> list[Motion]:
    """See `motions`.

    With the loads as states it is made in blocks of matrices, not step after step.
    """
    linear = with_loads(side.model.whole.ab, side.state.y, np.empty(0), loads)
    n, size = side.model.n, side.state.y.size
    steps = exponentials(linear.a, np.arange(BLOCK + 1) * step)
    across = steps[:BLOCK].reshape(-1, linear.a.shape[0])
    begins = np.empty((-(-count // BLOCK), linear.a.shape[0]))
    begins[0] = linear.state(0.0)
    for block in range(1, begins.shape[0]):
        begins[block] = steps[BLOCK] @ begins[block - 1]
    rows = (begins @ across.T).reshape(-1, linear.a.shape[0])[:count]
    on_dofs = np.zeros((n, loads.out.shape[0]))
    for column in range(side.model.listed_loads):
        on_dofs[side.model.load_dof[column], column] = 1.0
    pushed = on_dofs @ loads.out

    def seen(states: Floats) -> Motion:
        x, v, a = states[:, :n], states[:, n : 2 * n], states @ linear.a[n : 2 * n].T
        return Motion(x, v, a, states[:, size:] @ pushed.T)

    return [seen(rows), *(seen(rows[:-1] @ after.T) for after in exponentials(linear.a, offsets))]


def _by_kernel(side: Physical, count: int, step: int) -> Motion | None:
    """Motion at the rows alone, by the kernel of loops whose plant has laws; without accelerations and loads,
    which only energies need. None where that kernel does not fit.
    """
    loop = alone(side)
    rows = None if loop is None else rows_alone(loop, count, step)
    if rows is None:
        return None
    n, none = side.model.n, np.empty((count, 0))
    return Motion(rows[:, :n], rows[:, n:], none, none)


def motions(side: Physical, count: int, step: int, offsets: Integers) -> list[Motion]:
    """Motion at `count` rows, and at each of the offsets after all of them but the last."""
    loads = exosystem(side.model.loads)
    if side.model.laws is None and loads is not None:
        return _linear_motions(side, loads, count, step, offsets)
    if (fast := None if offsets.size else _by_kernel(side, count, step)) is not None:
        return [fast]
    each = 1 + offsets.size
    instants = np.arange(count)[:, None] * step + np.concatenate([[0], offsets])
    motion = _followed(side, instants.ravel()[: (count - 1) * each + 1])
    return [motion.at(slice(first, None, each)) for first in range(each)]
