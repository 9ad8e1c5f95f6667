"""A loop whose plant has laws that are not linear, as one linear system into which their forces are fed.

The joint state is ``y = [plant side, numerical side]``, the held inputs are ``[commands, latched motion]``,
and the forces g of the laws (and the rates of their own states) are further inputs. While some dofs stick,
the forces that hold them follow from all the others, so that each set of sticking dofs has a linear system of
its own in which they stay at rest exactly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.energy import EFFECTS
from rthm_core.engine.linear.ledger import LinearLedger, linear_ledger
from rthm_core.engine.linear.loop import LinearLoop, linear_part
from rthm_core.physical.laws import (
    CODE,
    FRICTION,
    LOADED,
    OTHER,
    PARTITION,
    PLACE,
    STATE,
    STATES,
    TIME,
    LawTable,
    law_table,
    plant_law,
)
from rthm_core.physical.side import build

if TYPE_CHECKING:
    from rthm_core.physical.advance import Physical
    from rthm_core.spec import Spec

MOST_STICKING = 3
"""Most dofs with dry friction for which every set that can stick has matrices of its own."""


class Nonlinear(NamedTuple):
    """Loop for compiled code; d is the length of [y, held, g], S the number of sets of sticking dofs.

    Attributes
    ----------
    systems : (S, N, d) array
        Rate of y.
    holds : (S, L, d) array
        Forces that hold the sticking dofs, in N.
    bits : (L,) array
        What each friction adds to the number of the set when it sticks; 0 for other laws.
    laws : LawTable
        With places and own states as positions in y.
    n : int
        Distance from a position to its velocity in y.
    input_matrix : (N, G) array
        Effect of g.
    weight : (G,) array
        Its largest.
    fastest : float
        Largest spectral radius of the dynamics, 1/s.
    steady : bool
        Whether all laws are dry friction that is constant in motion.
    modes : (L,) array
        At the start of a test.
    """

    systems: Floats
    holds: Floats
    bits: Integers
    laws: LawTable
    n: int
    input_matrix: Floats
    weight: Floats
    fastest: float
    steady: bool
    modes: Integers


class NonlinearLoop(NamedTuple):
    """The loop, what it is looked at through, and its start.

    Attributes
    ----------
    linear : LinearLoop
        Both sides without the laws; with its commands in two parts where work is counted.
    nonlinear : Nonlinear
    start : (N + M,) array
        State and held inputs.
    sample, force, reference : (., N + M) arrays
        Measured motion, forces in the wires, and F_d.
    motion : (2 n1 + 2 n2,) array
        Places of x1, v1, x2, v2 in y.
    forms : (7, d, d) array
        Six powers in W and the energy in J; empty where they are not counted.
    """

    linear: LinearLoop
    nonlinear: Nonlinear
    start: Floats
    sample: Floats
    force: Floats
    reference: Floats
    motion: Integers
    forms: Floats


def nonlinear_loop(spec: Spec, *, energies: bool) -> NonlinearLoop | None:
    """Matrices of a loop in which laws on the plant may be not linear; None where anything else is not."""
    physical = build(spec)
    laws, linear = physical.model.laws or law_table([]), linear_part(spec)
    if linear is None or physical.model.wires.laws.size:
        return None
    if np.sum(laws.numbers[:, PARTITION] == FRICTION) > MOST_STICKING:
        return None
    if np.any(laws.numbers[:, [LOADED, OTHER]] >= 0):
        return None
    if laws.heavy is not None or np.any(laws.numbers[:, PARTITION] == TIME):
        return None
    before, ledger = physical.state.q.size, linear_ledger(spec, linear) if energies else None
    if ledger is not None:
        before += ledger.loop.plant.a.shape[0] - linear.plant.a.shape[0]
        linear = ledger.loop
    nonlinear = _nonlinear(physical, laws, before, _joint(linear))
    sides = (linear.plant, linear.numerical)
    start = np.concatenate([*(side.state(0.0) for side in sides), *(side.held for side in sides)])
    forms = np.empty((0, 0, 0)) if ledger is None else _forms(ledger, linear, nonlinear)
    return NonlinearLoop(linear, nonlinear, start, *_looks(linear), forms)


def _places(loop: LinearLoop) -> list[Integers]:
    """Where plant, numerical side, commands and latched motion stand in [y, held]."""
    sizes = [loop.plant.a.shape[0], loop.numerical.a.shape[0], loop.plant.held.size, loop.numerical.held.size]
    return list(np.split(np.arange(sum(sizes)), np.cumsum(sizes)[:-1]))


def _joint(loop: LinearLoop) -> Floats:
    """Rate (N, N + M) of both sides together."""
    one, two, commands, held = _places(loop)
    joint = np.zeros((one.size + two.size, one.size + two.size + commands.size + held.size))
    joint[np.ix_(one, one)], joint[np.ix_(one, commands)] = loop.plant.a, loop.plant.b
    joint[np.ix_(two, two)], joint[np.ix_(two, held)] = loop.numerical.a, loop.numerical.b
    return joint


def _nonlinear(physical: Physical, laws: LawTable, before: int, joint: Floats) -> Nonlinear:
    """The laws on a loop whose plant's mechanics stand from place `before` on."""
    model, numbers = physical.model, laws.numbers.copy()
    numbers[:, [PLACE, STATE]] += before
    laws, size, count = laws._replace(numbers=numbers), joint.shape[0], numbers.shape[0]
    input_matrix = np.zeros((size, count + int(numbers[:, STATES].sum())))
    ny = model.mechanics.shape[0]
    input_matrix[before : before + ny, :count] = model.mechanics[:, model.mechanics.shape[1] - count :]
    own = [state for row in numbers for state in range(row[STATE], row[STATE] + row[STATES])]
    input_matrix[own, count + np.arange(len(own))] = 1.0
    rubbing = np.flatnonzero(numbers[:, PARTITION] == FRICTION)
    bits = np.zeros(count, dtype=np.int64)
    bits[rubbing] = 1 << np.arange(rubbing.size)
    free = np.hstack([joint, input_matrix])
    sets = [rubbing[[bool(s >> i & 1) for i in range(rubbing.size)]] for s in range(1 << rubbing.size)]
    systems, holds = zip(*(_sticking(free, laws, model.n, rows) for rows in sets), strict=True)
    fastest = max(np.abs(np.linalg.eigvals(one[:, :size])).max(initial=0.0) for one in systems)
    steady = all(law.constant and law.partition == "friction" for law in map(plant_law, numbers[:, CODE]))
    modes = physical.state.modes[:count].copy()
    return Nonlinear(
        np.stack(systems),
        np.stack(holds),
        bits,
        laws,
        model.n,
        input_matrix,
        np.abs(input_matrix).max(axis=0),
        float(fastest),
        steady,
        modes,
    )


def _sticking(free: Floats, laws: LawTable, n: int, rows: Integers) -> tuple[Floats, Floats]:
    """System while the frictions `rows` stick, and the forces that hold their dofs."""
    hold = np.zeros((laws.numbers.shape[0], free.shape[1]))
    if rows.size == 0:
        return free, hold
    velocities, columns = laws.numbers[rows, PLACE] + n, free.shape[1] - _inputs(laws) + rows
    hold[rows] = -np.linalg.solve(free[np.ix_(velocities, columns)], free[velocities])
    system = free + free[:, columns] @ hold[rows]
    system[velocities] = 0.0
    return system, hold


def _inputs(laws: LawTable) -> int:
    """Number of entries of g."""
    return int(laws.numbers.shape[0] + laws.numbers[:, STATES].sum())


def _looks(loop: LinearLoop) -> tuple[Floats, Floats, Floats, Integers]:
    """Measured motion, forces in the wires and F_d from [y, held]; and where the motion stands in y."""
    one, two, commands, held = _places(loop)
    n, size, m = loop.rows.shape[0] - loop.k_tot.size, held[-1] + 1, loop.k_tot.size
    sample, force, reference = np.zeros((2 * m, size)), np.zeros((m, size)), np.zeros((m, size))
    plant = np.concatenate([one, commands])
    sample[:, plant], force[:, plant] = loop.sample, loop.rows[n:]
    reference[:, np.concatenate([two, held])] = loop.reference
    x1v1 = plant[np.argmax(loop.rows[:n] != 0.0, axis=1)]
    return sample, force, reference, np.concatenate([x1v1, two[: loop.numerical.y.size]])


def _forms(ledger: LinearLedger, loop: LinearLoop, nonlinear: Nonlinear) -> Floats:
    """Powers and energy over [y, held, g]: a law's power is its force times the velocity of its dof."""
    one, two, commands, held = _places(loop)
    order = np.argsort(np.concatenate([one, commands, two, held]))
    size, d = order.size, nonlinear.systems.shape[2]
    forms = np.zeros((ledger.forms.shape[0], d, d))
    forms[:, :size, :size] = ledger.forms[:, order][:, :, order]
    for row, place in enumerate(nonlinear.laws.numbers[:, PLACE] + nonlinear.n):
        forms[EFFECTS, place, size + row] += 0.5
        forms[EFFECTS, size + row, place] += 0.5
    return forms
