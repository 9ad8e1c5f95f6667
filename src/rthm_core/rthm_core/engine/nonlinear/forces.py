"""Forces of the laws on a loop's plant and of its wires, compiled."""

from __future__ import annotations

from rthm_core.compiled import inlined
from rthm_core.physical.laws import (
    CODE,
    FRICTION,
    PARTITION,
    PLACE,
    STATE,
    STATES,
    plant_force,
    plant_rate,
    wire_law_force,
)


@inlined
def wire_force(wires, wire, u, x, v, k, parameters):  # type: ignore[no-untyped-def]
    """Force of a wire of stiffness `k` between its motor's side at `u` and its dof."""
    force = k * (u - x)
    for row in range(wires.laws.shape[0]):
        if wires.laws[row, 1] == wire:
            force = wire_law_force(
                wires.laws[row, 0], u, x, v, k, force, parameters[row, :0], parameters[row]
            )
    return force


@inlined
def drive_side(wires, wire, y):  # type: ignore[no-untyped-def]
    """Position of the motor's side of a wire; y is [y, held]."""
    u = 0.0
    for j in range(wires.drive.shape[1]):
        u += wires.drive[wire, j] * y[j]
    return u


@inlined
def wire_forces(nonlinear, y, out):  # type: ignore[no-untyped-def]
    """Forces of the wires that are not linear, into the last elements of `out`; y is [y, held]."""
    wires = nonlinear.wires
    first = out.size - wires.dof.size
    for wire in range(wires.dof.size):
        u, x, v = drive_side(wires, wire, y), y[wires.dof[wire]], y[wires.dof[wire] + nonlinear.n]
        out[first + wire] = wire_force(wires, wire, u, x, v, wires.stiffness[wire], wires.parameters)


@inlined
def forces(nonlinear, y, t, modes, out):  # type: ignore[no-untyped-def]
    """Forces of the laws, rates of their own states, and forces of the wires, at time `t` (s)."""
    laws, n = nonlinear.laws, nonlinear.n
    own = laws.numbers.shape[0]
    for row in range(laws.numbers.shape[0]):
        states = laws.numbers[row, STATES]
        out[row] = 0.0
        for i in range(own, own + states):
            out[i] = 0.0
        if laws.numbers[row, PARTITION] != FRICTION or modes[row] != 0:
            dof, z, code = laws.numbers[row, PLACE], laws.numbers[row, STATE], laws.numbers[row, CODE]
            p = laws.parameters[row]
            out[row] = plant_force(code, y[dof], y[n + dof], y[z : z + states], t, p, modes[row])
            if states:
                rates = out[own : own + states]
                plant_rate(code, y[dof], y[n + dof], y[z : z + states], t, p, modes[row], rates)
        own += states
    wire_forces(nonlinear, y, out)
