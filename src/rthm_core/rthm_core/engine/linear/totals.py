"""Work of a linear loop from few numbers: from the state of the loop itself, and from what it does not tell.

Most powers depend on the sum of both parts of a command, and all of them on the force of the held motion
alone, so that fewer products of two numbers matter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.engine.linear.ledger import LinearLedger
from rthm_core.engine.linear.loop import LinearLoop, Side

UNFELT = 1e-14
"""What of the held motion matters by less than that of the rest does not matter."""


class Aside(NamedTuple):
    """What work depends on beside the loop: ``dr/dt = a r + b held``.

    Attributes
    ----------
    a, b : arrays
        Dynamics, and effect of the commands and of their feedforward parts.
    y, held : arrays
        State and inputs at the start of a test.
    felt : (., 2 m) array
        What of the motion that the numerical side holds matters.
    """

    a: Floats
    b: Floats
    y: Floats
    held: Floats
    felt: Floats


NOTHING = Aside(np.zeros((0, 0)), np.zeros((0, 0)), np.zeros(0), np.zeros(0), np.zeros((0, 0)))
"""Where no work is counted."""


def beside(ledger: LinearLedger, loop: LinearLoop) -> tuple[Aside, LinearLedger]:
    """What is beside a loop, and its ledger over z = [plant, aside, commands, feedforward, numerical, felt].

    Aside is what h(s) makes of the feedforward, and of the commands where that is not in the plant already:
    effects in the motors make that another.
    """
    n, m, parted = loop.plant.a.shape[0], loop.k_tot.size, ledger.loop.plant
    chain = (parted.a.shape[0] - n) // 2
    felt = _felt(np.vstack([ledger.joint[:, -2 * m :], *ledger.forms[:, :, -2 * m :]]))
    sizes = [chain, chain, n, m, m, loop.numerical.a.shape[0], 2 * m]
    old, new = _changed(sizes, felt, shared=_starts_with_motor(parted, chain))
    joint = new @ ledger.joint @ old
    end = joint.shape[0] - felt.shape[0] - sizes[-2] - 2 * m
    aside = Aside(
        joint[n:end, n:end],
        joint[n:end, end : end + 2 * m],
        new[n:end, : 2 * chain] @ parted.y[: 2 * chain],
        np.concatenate([loop.plant.held, parted.held[m:]]),
        felt,
    )
    return aside, LinearLedger(loop, joint, old.T @ ledger.forms @ old)


def _starts_with_motor(side: Side, chain: int) -> bool:
    """Whether the first states of the plant are what h(s) makes of the whole command."""
    ff, own, m = slice(chain, 2 * chain), slice(2 * chain, 3 * chain), side.held.size // 2
    same = np.array_equal(side.a[own, own], side.a[ff, ff])
    same = same and np.array_equal(side.b[own, m:], side.b[ff, m:]) and not side.a[own, 3 * chain :].any()
    return bool(same and np.allclose(side.y[own], side.y[:chain] + side.y[ff], rtol=UNFELT, atol=0.0))


def _felt(effects: Floats) -> Floats:
    """Directions of the held motion that have effects (., 2 m), actuator by actuator."""
    m, rows = effects.shape[1] // 2, []
    for actuator in range(m):
        which = [actuator, m + actuator]
        _, sizes, directions = np.linalg.svd(effects[:, which], full_matrices=False)
        for direction in directions[sizes > UNFELT * sizes[0]]:
            rows.append(np.zeros(2 * m))
            rows[-1][which] = direction
    return np.array(rows).reshape(-1, 2 * m)


def _changed(sizes: list[int], felt: Floats, *, shared: bool) -> tuple[Floats, Floats]:
    """Matrices that give the ledger's own z, in parts of such sizes, from the changed one, and the other way
    round.
    """
    fx, ff, plant, u_fx, u_ff, numerical, held = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])
    totals = (fx + ff)[: 0 if shared else None]
    new = np.vstack([plant, ff, totals, u_fx + u_ff, u_ff, numerical, felt @ held])
    chain = sizes[0]
    parts = [sizes[2], chain, totals.shape[0], *sizes[3:6]]
    plant, ff, totals, u, u_ff, numerical, felt_now = np.split(np.eye(new.shape[0]), np.cumsum(parts))
    totals = plant[:chain] if shared else totals
    old = np.vstack([totals - ff, ff, plant, u - u_ff, u_ff, numerical, felt.T @ felt_now])
    return old, new
