"""Rates of plant and wires, compiled: the simulator's laws of force on the arrays of a replay."""

from __future__ import annotations

from rthm_analysis.diagnosis.replay.compiled import inlined
from rthm_core.physical.laws import (
    CODE,
    DOF,
    FRICTION,
    NONLINEAR,
    PARTITION,
    PLACE,
    POSITION,
    STATE,
    STATES,
    plant_force,
    plant_rate,
    wire_drive,
    wire_law_force,
    wire_rate,
    wire_settle,
)


@inlined
def product(row, y, u):  # type: ignore[no-untyped-def]
    """Scalar product of a row with [y, u]."""
    total = 0.0
    for j in range(y.size):
        total += row[j] * y[j]
    for j in range(u.size):
        total += row[y.size + j] * u[j]
    return total


@inlined
def nonlinear_wire(actuator, n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, dy, commit):  # type: ignore[no-untyped-def]
    """Force of a nonlinear wire; `z` is scratch, and gets into `y` the settled states when `commit`."""
    k, dof = stiffness[actuator, 0], wires[actuator, DOF]
    x, v = y[dof], y[n + dof]
    position = product(drive[actuator], y, u)
    for row in range(wire_laws.shape[0]):
        if wire_laws[row, PLACE] == actuator:
            begin, end = wire_laws[row, STATE], wire_laws[row, STATE] + wire_laws[row, STATES]
            for i in range(begin, end):
                z[i] = y[i]
            wire_settle(wire_laws[row, CODE], position, x, k, z[begin:end], wire_parameters[row])
            position = wire_drive(wire_laws[row, CODE], position, z[begin:end], wire_parameters[row])
    force = k * (position - x)
    for row in range(wire_laws.shape[0]):
        if wire_laws[row, PLACE] == actuator:
            begin, end = wire_laws[row, STATE], wire_laws[row, STATE] + wire_laws[row, STATES]
            p, own = wire_parameters[row], z[begin:end]
            force = wire_law_force(wire_laws[row, CODE], position, x, v, k, force, own, p)
            wire_rate(wire_laws[row, CODE], position, x, v, k, own, p, dy[begin:end])
            if commit:
                for i in range(begin, end):
                    y[i] = z[i]
    return force


@inlined
def mode_of(row, laws, thresholds, x, v):  # type: ignore[no-untyped-def]
    """Piece of a law that is no dry friction."""
    if laws[row, PARTITION] == POSITION:
        return (1 if x > thresholds[row, 0] else 0) + (1 if x > thresholds[row, 1] else 0)
    return 1 if v >= 0.0 else -1


@inlined
def _hold(m, n, b, inverse_mass, laws, modes, dy, hold, sticking):  # type: ignore[no-untyped-def]
    """Forces that keep the sticking dofs at rest together, by sweeps over them."""
    for _ in range(1 if sticking == 1 else 200):
        change = 0.0
        for row in range(laws.shape[0]):
            if laws[row, PARTITION] == FRICTION and modes[row] == 0:
                dof = laws[row, PLACE]
                force = -dy[n + dof] / inverse_mass[dof, dof]
                hold[row] += force
                change = max(change, abs(force) - 1e-12 * abs(hold[row]))
                for i in range(dy.size):
                    dy[i] += b[i, n + 2 * m + row] * force
                dy[n + dof] = 0.0
        if change <= 0.0:
            return


@inlined
def rate(
    n,
    a,
    b,
    inverse_mass,
    wires,
    stiffness,
    drive,
    wire_laws,
    wire_parameters,
    laws,
    parameters,
    thresholds,
    y,
    u,
    w,
    t,
    modes,
    dy,
    hold,
    z,
):  # type: ignore[no-untyped-def]
    """dy/dt; `hold` gets the forces that hold sticking dofs."""
    m = u.size
    for i in range(y.size):
        total = 0.0
        for j in range(y.size):
            total += a[i, j] * y[j]
        for j in range(m):
            total += b[i, j] * u[j]
        for j in range(n):
            total += b[i, m + j] * w[j]
        dy[i] = total
    for actuator in range(m):
        if wires[actuator, NONLINEAR]:
            force = nonlinear_wire(
                actuator, n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, dy, False
            )
            for i in range(y.size):
                dy[i] += b[i, m + n + actuator] * force
    sticking = 0
    for row in range(laws.shape[0]):
        hold[row] = 0.0
        if laws[row, PARTITION] == FRICTION and modes[row] == 0:
            sticking += 1
            continue
        dof, begin = laws[row, PLACE], laws[row, STATE]
        end = begin + laws[row, STATES]
        x, v, p = y[dof], y[n + dof], parameters[row]
        frozen = laws[row, PARTITION] == FRICTION or laws[row, PARTITION] == POSITION
        mode = modes[row] if frozen else mode_of(row, laws, thresholds, x, v)
        force = plant_force(laws[row, CODE], x, v, y[begin:end], t, p, mode)
        plant_rate(laws[row, CODE], x, v, y[begin:end], t, p, mode, dy[begin:end])
        for i in range(y.size):
            dy[i] += b[i, 2 * m + n + row] * force
    if sticking:
        _hold(m, n, b, inverse_mass, laws, modes, dy, hold, sticking)


@inlined
def settle_wires(n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch):  # type: ignore[no-untyped-def]
    """Bring path-dependent states of the wires up to the present motion."""
    for actuator in range(u.size):
        if wires[actuator, NONLINEAR]:
            nonlinear_wire(
                actuator, n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch, True
            )
