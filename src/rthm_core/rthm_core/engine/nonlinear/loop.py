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
from rthm_core.engine.linear.loop import LinearLoop, exosystem, linear_part, with_loads
from rthm_core.loads import together
from rthm_core.physical.laws import (
    CODE,
    DOF,
    FRICTION,
    LOADED,
    OTHER,
    PARTITION,
    PLACE,
    STATE,
    STATES,
    TIME,
    LawTable,
    WireTable,
    law_of,
    law_table,
)
from rthm_core.physical.side import build

if TYPE_CHECKING:
    from rthm_core.physical.advance import Physical
    from rthm_core.spec import Spec

MOST_STICKING = 3
"""Most dofs with dry friction for which every set that can stick has matrices of its own."""


class Wires(NamedTuple):
    """Wires that are not linear but smooth: W of them, whose forces are the last elements of g.

    Attributes
    ----------
    actuator : (W,) array
    drive : (W, N + M) array
        Position of their motor's side from [y, held].
    states : (.,) array
        Places in y of what these positions depend on.
    dof : (W,) array
        Place of the position of their dof in y.
    stiffness : (W,) array
        N/m.
    laws : (R, 2) array
        Code of each law and its wire.
    parameters : (R, 8) array
    """

    actuator: Integers
    drive: Floats
    states: Integers
    dof: Integers
    stiffness: Floats
    laws: Integers
    parameters: Floats


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
    felt : (F,) array
        Places in y of what the laws depend on.
    fastest : float
        Largest spectral radius of the dynamics, 1/s.
    steady : bool
        Whether all laws are dry friction that is constant in motion.
    modes : (L,) array
        At the start of a test.
    wires : Wires
        Those whose force is no linear one.
    """

    systems: Floats
    holds: Floats
    bits: Integers
    laws: LawTable
    n: int
    input_matrix: Floats
    weight: Floats
    felt: Integers
    fastest: float
    steady: bool
    modes: Integers
    wires: Wires


class NonlinearLoop(NamedTuple):
    """The loop, what it is looked at through, and its start.

    Attributes
    ----------
    linear : LinearLoop
        Both sides without the laws; with its commands in two parts where work is counted.
    nonlinear : Nonlinear
    start : (N + M,) array
        State and held inputs.
    sample, force, reference : (., d) arrays
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
    if linear is None or not _smooth(physical.model.wires) or not _fits(laws):
        return None
    if laws.heavy is not None or np.any(laws.numbers[:, PARTITION] == TIME):
        return None
    before, ledger = physical.state.q.size, linear_ledger(spec, linear) if energies else None
    if ledger is not None:
        before += ledger.loop.plant.a.shape[0] - linear.plant.a.shape[0]
        linear = ledger.loop
    nonlinear = _nonlinear(physical, laws, before, _joint(linear), _wires(physical, linear, before))
    sides = (linear.plant, linear.numerical)
    start = np.concatenate([*(side.state(0.0) for side in sides), *(side.held for side in sides)])
    forms = np.empty((0, 0, 0)) if ledger is None else _forms(ledger, linear, nonlinear)
    return NonlinearLoop(linear, nonlinear, start, *_looks(linear, nonlinear), forms)


def _smooth(wires: WireTable) -> bool:
    """Whether the forces of all wires follow smoothly from where their ends are."""
    laws = map(law_of, wires.laws[:, CODE])
    return not (np.any(wires.laws[:, STATES]) or any(law.kinked or any(law.path) for law in laws))


def _wires(physical: Physical, linear: LinearLoop, before: int) -> Wires:
    """Wires that are not linear, on a loop whose plant's mechanics stand from place `before` on."""
    table = physical.model.wires
    chosen, which = np.unique(table.laws[:, PLACE], return_inverse=True)
    places = _places(linear)
    drive = np.zeros((chosen.size, sum(map(len, places))))
    drive[:, np.concatenate(places[::2])] = linear.motors[chosen]
    size = places[0].size + places[1].size
    return Wires(
        chosen,
        drive,
        np.flatnonzero(np.any(drive[:, :size] != 0.0, axis=0)),
        before + table.numbers[chosen, DOF],
        table.stiffness[chosen, 0].copy(),
        np.stack([table.laws[:, CODE], which], axis=1),
        table.parameters.copy(),
    )


def _fits(laws: LawTable) -> bool:
    """Whether the kernel can compute with some laws."""
    rubbing, elsewhere = laws.numbers[:, PARTITION] == FRICTION, laws.numbers[:, [LOADED, OTHER]] >= 0
    return bool(np.sum(rubbing) <= MOST_STICKING and not np.any(elsewhere))


def alone(physical: Physical) -> NonlinearLoop | None:
    """A plant without actuators as a loop through which nothing passes; None where anything but its laws is
    not linear.
    """
    laws, loads = physical.model.laws or law_table([]), exosystem(physical.model.loads)
    if loads is None or not _fits(laws):
        return None
    no, none, nothing = np.empty(0), np.empty((0, 0)), exosystem(together([]))
    assert nothing is not None
    plant = with_loads(physical.model.whole.ab, physical.state.whole, no, loads)
    rows = np.eye(2 * physical.model.n, plant.a.shape[0])
    numerical = with_loads(none, no, no, nothing)
    linear = LinearLoop(plant, numerical, rows[:0], no, None, rows, rows[:0], none, no, no, no)
    nonlinear = _nonlinear(physical, laws, 0, _joint(linear), _wires(physical, linear, 0))
    return NonlinearLoop(linear, nonlinear, plant.state(0.0), *_looks(linear, nonlinear), np.empty((0, 0, 0)))


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


def _nonlinear(physical: Physical, laws: LawTable, before: int, joint: Floats, wires: Wires) -> Nonlinear:
    """The laws on a loop whose plant's mechanics stand from place `before` on."""
    model, numbers = physical.model, laws.numbers.copy()
    numbers[:, [PLACE, STATE]] += before
    laws, size, count = laws._replace(numbers=numbers), joint.shape[0], numbers.shape[0]
    own = [state for row in numbers for state in range(row[STATE], row[STATE] + row[STATES])]
    pulls = count + len(own)
    input_matrix = np.zeros((size, pulls + wires.dof.size))
    ny, columns = model.mechanics.shape
    input_matrix[before : before + ny, :count] = model.mechanics[:, columns - count :]
    input_matrix[own, count + np.arange(len(own))] = 1.0
    input_matrix[before : before + ny, pulls:] = model.mechanics[
        :, columns - count - model.m + wires.actuator
    ]
    rubbing = np.flatnonzero(numbers[:, PARTITION] == FRICTION)
    bits = np.zeros(count, dtype=np.int64)
    bits[rubbing] = 1 << np.arange(rubbing.size)
    free = np.hstack([joint, input_matrix])
    sets = [rubbing[[bool(s >> i & 1) for i in range(rubbing.size)]] for s in range(1 << rubbing.size)]
    stuck = (_sticking(free, input_matrix.shape[1], laws, model.n, rows) for rows in sets)
    systems, holds = zip(*stuck, strict=True)
    fastest = max(np.abs(np.linalg.eigvals(one[:, :size])).max(initial=0.0) for one in systems)
    constant = all(law.constant and law.partition == "friction" for law in map(law_of, numbers[:, CODE]))
    modes = physical.state.modes[:count].copy()
    return Nonlinear(
        np.stack(systems),
        np.stack(holds),
        bits,
        laws,
        model.n,
        input_matrix,
        np.abs(input_matrix).max(axis=0),
        _felt(model.n, numbers, own, wires),
        float(fastest),
        constant and not wires.dof.size,
        modes,
        wires,
    )


def _felt(n: int, numbers: Integers, own: list[int], wires: Wires) -> Integers:
    """Places in y of what laws and wires depend on."""
    dofs = np.concatenate([numbers[:, PLACE], wires.dof])
    return np.unique(np.concatenate([dofs, dofs + n, own, wires.states])).astype(np.int64)


def _sticking(free: Floats, inputs: int, laws: LawTable, n: int, rows: Integers) -> tuple[Floats, Floats]:
    """System while the frictions `rows` stick, and the forces that hold their dofs."""
    hold = np.zeros((laws.numbers.shape[0], free.shape[1]))
    if rows.size == 0:
        return free, hold
    velocities, columns = laws.numbers[rows, PLACE] + n, free.shape[1] - inputs + rows
    hold[rows] = -np.linalg.solve(free[np.ix_(velocities, columns)], free[velocities])
    system = free + free[:, columns] @ hold[rows]
    system[velocities] = 0.0
    return system, hold


def _looks(loop: LinearLoop, nonlinear: Nonlinear) -> tuple[Floats, Floats, Floats, Integers]:
    """Measured motion, forces in the wires and F_d from [y, held, g]; and where the motion stands in y."""
    one, two, commands, held = _places(loop)
    n, size, m = loop.rows.shape[0] - loop.k_tot.size, nonlinear.systems.shape[2], loop.k_tot.size
    sample, force, reference = np.zeros((2 * m, size)), np.zeros((m, size)), np.zeros((m, size))
    plant = np.concatenate([one, commands])
    sample[:, plant], force[:, plant] = loop.sample, loop.rows[n:]
    reference[:, np.concatenate([two, held])] = loop.reference
    wires = nonlinear.wires.actuator
    force[wires, size - wires.size + np.arange(wires.size)] = 1.0
    x1v1 = plant[np.argmax(loop.rows[:n] != 0.0, axis=1)]
    return sample, force, reference, np.concatenate([x1v1, two[: loop.numerical.y.size]])


def _forms(ledger: LinearLedger, loop: LinearLoop, nonlinear: Nonlinear) -> Floats:
    """Powers and energy over [y, held, g]: the power of a law, and of a wire that has no force in the linear
    part, is its force times the velocity of its dof.
    """
    one, two, commands, held = _places(loop)
    order = np.argsort(np.concatenate([one, commands, two, held]))
    size, d = order.size, nonlinear.systems.shape[2]
    forms = np.zeros((ledger.forms.shape[0], d, d))
    forms[:, :size, :size] = ledger.forms[:, order][:, :, order]
    count, wires = nonlinear.laws.numbers.shape[0], nonlinear.wires.dof.size
    inputs = [*range(size, size + count), *range(d - wires, d)]
    places = np.concatenate([nonlinear.laws.numbers[:, PLACE], nonlinear.wires.dof]) + nonlinear.n
    for place, one in zip(places, inputs, strict=True):
        forms[EFFECTS, place, one] += 0.5
        forms[EFFECTS, one, place] += 0.5
    return forms
