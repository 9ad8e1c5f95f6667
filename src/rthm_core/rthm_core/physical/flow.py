"""Time derivative of the mechanics, with the laws that are not linear."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import called, copy_into, inlined
from rthm_core.effects.laws import LOAD
from rthm_core.physical.laws import (
    CODE,
    DOF,
    FRICTION,
    LOADED,
    NONLINEAR,
    OTHER,
    PARTITION,
    PLACE,
    SLACKENS,
    STATE,
    STATES,
    plant_force,
    plant_rate,
    wire_drive,
    wire_law_force,
    wire_rate,
    wire_settle,
)
from rthm_core.physical.masses import carry
from rthm_core.physical.switching import motion_of, stop


@inlined
def product(row, y, u):  # type: ignore[no-untyped-def]
    """Product of a row with [y, u]."""
    total = 0.0
    for j in range(y.size):
        total += row[j] * y[j]
    for j in range(u.size):
        total += row[y.size + j] * u[j]
    return total


@inlined
def settle_wire(wires, y, u, actuator):  # type: ignore[no-untyped-def]
    """Bring path-dependent states of one wire up to the present motion, in place; returns the drive-side
    position that the wire feels.
    """
    position = product(wires.drive[actuator], y, u)
    x, k = y[wires.numbers[actuator, DOF]], wires.stiffness[actuator, 0]
    for row in range(wires.laws.shape[0]):
        if wires.laws[row, PLACE] == actuator:
            begin = wires.laws[row, STATE]
            z = y[begin : begin + wires.laws[row, STATES]]
            wire_settle(wires.laws[row, CODE], position, x, k, z, wires.parameters[row])
            position = wire_drive(wires.laws[row, CODE], position, z, wires.parameters[row])
    return position


@called
def settle_wires(wires, y, u):  # type: ignore[no-untyped-def]
    """Bring path-dependent states of all wires up to the present motion, in place."""
    for actuator in range(u.size):
        if wires.numbers[actuator, NONLINEAR]:
            settle_wire(wires, y, u, actuator)


@called
def wire_force(laws, wires, n, y, u, actuator, scratch, dy, hold):  # type: ignore[no-untyped-def]
    """Force of one wire, in N; of a wire that is not linear, also the rates of its laws' states, into
    `dy`.
    """
    if laws is None:
        return product(wires.force[actuator], y, u)
    return _any_wire_force(laws, wires, n, y, u, actuator, scratch, dy, hold)


@inlined
def _any_wire_force(laws, wires, n, y, u, actuator, scratch, dy, hold):  # type: ignore[no-untyped-def]
    """Force of a wire of any kind; ``hold[L + actuator]`` gets its tension, in N, if it can go slack."""
    tension = laws.numbers.shape[0] + actuator
    hold[tension] = np.inf
    if not wires.numbers[actuator, NONLINEAR]:
        return product(wires.force[actuator], y, u)
    copy_into(scratch, y)
    position = settle_wire(wires, scratch, u, actuator)
    dof, k = wires.numbers[actuator, DOF], wires.stiffness[actuator, 0]
    x, v = y[dof], y[n + dof]
    force = k * (position - x)
    for row in range(wires.laws.shape[0]):
        if wires.laws[row, PLACE] == actuator:
            if wires.laws[row, SLACKENS]:
                hold[tension] = force + wires.parameters[row, 0]
            begin, end = wires.laws[row, STATE], wires.laws[row, STATE] + wires.laws[row, STATES]
            force = wire_law_force(
                wires.laws[row, CODE], position, x, v, k, force, scratch[begin:end], wires.parameters[row]
            )
            wire_rate(
                wires.laws[row, CODE],
                position,
                x,
                v,
                k,
                scratch[begin:end],
                wires.parameters[row],
                dy[begin:end],
            )
    return force


@inlined
def _add(mechanics, column, force, dy):  # type: ignore[no-untyped-def]
    """Add a fed-back force to the rates."""
    for i in range(dy.size):
        dy[i] += mechanics[i, column] * force


@inlined
def _add_law(laws, row, mechanics, column, n, mode, y, w, t, dy):  # type: ignore[no-untyped-def]
    """Add the force of one plant law, and the rates of its own states."""
    begin, end = laws.numbers[row, STATE], laws.numbers[row, STATE] + laws.numbers[row, STATES]
    code, p = laws.numbers[row, CODE], laws.parameters[row]
    x, v = motion_of(laws, n, row, y)
    if laws.numbers[row, LOADED] >= 0:
        p[LOAD] = w[laws.numbers[row, LOADED]]
    _add(mechanics, column, plant_force(code, x, v, y[begin:end], t, p, mode), dy)
    if end > begin:
        plant_rate(code, x, v, y[begin:end], t, p, mode, dy[begin:end])


@inlined
def mechanics_rate(laws, model, modes, y, u, w, t, dy, hold, scratch):  # type: ignore[no-untyped-def]
    """Time derivative `dy` of the mechanics; `hold` gets the forces that hold sticking dofs (one per law),
    then the
    tensions of the wires.

    `laws` is ``model.laws``, handed over by itself: where it is None, everything that is not linear is left
    out of the compiled code.
    """
    mechanics = model.mechanics
    size, m, loads = y.size, u.size, w.size
    for i in range(size):
        rate = 0.0
        for j in range(size):
            rate += mechanics[i, j] * y[j]
        for j in range(m):
            rate += mechanics[i, size + j] * u[j]
        for j in range(loads):
            rate += mechanics[i, size + m + j] * w[j]
        dy[i] = rate
    if laws is not None:
        _add_nonlinear(laws, laws.heavy, model, modes, y, u, w, size + m + loads, t, dy, hold, scratch)


@inlined
def _add_nonlinear(laws, heavy, model, modes, y, u, w, first, t, dy, hold, scratch):  # type: ignore[no-untyped-def]
    """Add what wires and laws that are not linear do; their forces enter through the columns of
    ``model.mechanics`` from `first` on. `heavy` is ``laws.heavy``, handed over by itself as well.
    """
    m = u.size
    for actuator in range(m):
        if model.wires.numbers[actuator, NONLINEAR]:
            _add(
                model.mechanics,
                first + actuator,
                _any_wire_force(laws, model.wires, model.n, y, u, actuator, scratch, dy, hold),
                dy,
            )
    sticking = 0
    for row in range(laws.numbers.shape[0]):
        hold[row] = 0.0
        if laws.numbers[row, PARTITION] == FRICTION and modes[row] == 0:
            sticking += 1
        else:
            _add_law(laws, row, model.mechanics, first + m + row, model.n, modes[row], y, w, t, dy)
    if heavy is not None:
        carry(laws, heavy, heavy.coupled, model.n, modes, y, t, dy, scratch)
        if sticking:
            _hold(laws, model.n, heavy.inverse, modes, dy, hold, sticking)
    elif sticking:
        _hold(laws, model.n, model.inverse_mass, modes, dy, hold, sticking)


@inlined
def _pushed(laws, row, inverse_mass, i):  # type: ignore[no-untyped-def]
    """Acceleration of dof `i` by a unit of a law's force."""
    dof, other = laws.numbers[row, PLACE], laws.numbers[row, OTHER]
    found = inverse_mass[i, dof]
    if other >= 0:
        found -= inverse_mass[i, other]
    return found


@inlined
def _mobility(laws, row, inverse_mass):  # type: ignore[no-untyped-def]
    """Acceleration of a law's dof, less that of the other, by a unit of its force."""
    dof, other = laws.numbers[row, PLACE], laws.numbers[row, OTHER]
    found = inverse_mass[dof, dof]
    if other >= 0:
        found += inverse_mass[other, other] - 2.0 * inverse_mass[dof, other]
    return found


@inlined
def _hold(laws, n, inverse_mass, modes, dy, hold, sticking):  # type: ignore[no-untyped-def]
    """Find the forces that keep the sticking dofs at rest together, by sweeps over them; one dof alone needs
    one sweep.
    """
    for _ in range(1 if sticking == 1 else 200):
        change = 0.0
        for row in range(laws.numbers.shape[0]):
            if laws.numbers[row, PARTITION] == FRICTION and modes[row] == 0:
                _, apart = motion_of(laws, n, row, dy)
                force = -apart / _mobility(laws, row, inverse_mass)
                hold[row] += force
                change = max(change, abs(force) - 1e-15 * abs(hold[row]))
                for i in range(n):
                    dy[n + i] += _pushed(laws, row, inverse_mass, i) * force
                stop(laws, n, row, dy)
        if change <= 0.0:
            return
