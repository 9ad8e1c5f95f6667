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
def wire_forces(nonlinear, y, out):  # type: ignore[no-untyped-def]
    """Forces of the wires that are not linear, into the last elements of `out`; y is [y, held]."""
    wires = nonlinear.wires
    first = out.size - wires.dof.size
    for wire in range(wires.dof.size):
        u, x, v = 0.0, y[wires.dof[wire]], y[wires.dof[wire] + nonlinear.n]
        for j in range(wires.drive.shape[1]):
            u += wires.drive[wire, j] * y[j]
        k = wires.stiffness[wire]
        force = k * (u - x)
        for row in range(wires.laws.shape[0]):
            if wires.laws[row, 1] == wire:
                code, p = wires.laws[row, 0], wires.parameters[row]
                force = wire_law_force(code, u, x, v, k, force, y[:0], p)
        out[first + wire] = force


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
