"""From a spec to the arrays that the replay of plant and wire works on."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.physical.laws import DOF, PULLEY
from rthm_core.physical.model import PhysicalModel, physical_model
from rthm_core.physical.side import first_command

if TYPE_CHECKING:
    from rthm_core.spec import Spec

NO_NUMBERS, NO_VALUES = np.empty((0, 5), dtype=np.int64), np.empty((0, 8))


class Mechanics(NamedTuple):
    """Plant and wires as arrays; see ``rthm_core.physical`` for the meaning of the tables.

    Attributes
    ----------
    a : (ny, ny) array
        Linear mechanics.
    b : (ny, m + n + m + r) array
        Effect on dy/dt of motor positions, loads on the dofs, forces of nonlinear wires, of nonlinear laws.
    inverse_mass : (n, n) array
    wires : (m, 3) integers
    stiffness : (m, 2) array
    drive, force : (m, ny + m) arrays
    wire_laws, wire_parameters : (W, 4), (W, 8) arrays
    laws, parameters, thresholds, breakaway : (R, 5), (R, 8), (R, 2), (R,) arrays
    initial : (ny,) array
    """

    a: Floats
    b: Floats
    inverse_mass: Floats
    wires: Integers
    stiffness: Floats
    drive: Floats
    force: Floats
    wire_laws: Integers
    wire_parameters: Floats
    laws: Integers
    parameters: Floats
    thresholds: Floats
    breakaway: Floats
    initial: Floats


def mechanics(spec: Spec, first_motor: Floats | None = None) -> Mechanics:
    """Plant and wires of a spec whose sensors and motors are left to others.

    Parameters
    ----------
    spec : Spec
        With a plant.
    first_motor : (m,) array, optional
        Motor positions before the test; by default what the spec's first command gives.
    """
    assert spec.plant is not None
    model, resting = physical_model(spec)
    n, m, ny = model.n, model.m, model.mechanics.shape[0]
    loads = model.load_dof.size
    columns = model.mechanics
    by_force = np.zeros((ny, n))
    by_force[n : 2 * n] = model.inverse_mass
    b = np.hstack([columns[:, ny : ny + m], by_force, columns[:, ny + m + loads :]])
    laws = model.laws
    initial = np.zeros(ny)
    initial[:n], initial[n : 2 * n] = spec.plant.initial_position, spec.plant.initial_velocity
    u = first_command(spec) if first_motor is None else first_motor
    _rest(model, resting, initial, u)
    return Mechanics(
        np.ascontiguousarray(columns[:, :ny]),
        np.ascontiguousarray(b),
        np.ascontiguousarray(model.inverse_mass),
        model.wires.numbers,
        model.wires.stiffness,
        np.ascontiguousarray(model.wires.drive).reshape(m, ny + m),
        np.ascontiguousarray(model.wires.force).reshape(m, ny + m),
        model.wires.laws,
        model.wires.parameters,
        NO_NUMBERS if laws is None else laws.numbers,
        NO_VALUES if laws is None else laws.parameters,
        np.empty((0, 2)) if laws is None else laws.thresholds,
        np.empty(0) if laws is None else laws.breakaway,
        initial,
    )


def _rest(model: PhysicalModel, resting: list, y: Floats, u: Floats) -> None:  # type: ignore[type-arg]
    """Own states of pulleys and laws in steady state at the initial position."""
    wires = model.wires
    for actuator, row in enumerate(wires.numbers.tolist()):
        if row[PULLEY] >= 0:
            k, nominal = wires.stiffness[actuator]
            soft = 1.0 / (1.0 / nominal - 1.0 / k)
            y[row[PULLEY]] = (soft * u[actuator] + k * y[row[DOF]]) / (soft + k)
    for law, p, where, place, at in resting:
        if where == "plant":
            y[at : at + law.states] = law.initial(y[place], p)
        else:
            position = wires.drive[place] @ np.concatenate([y, u])
            y[at : at + law.states] = law.initial(position, y[wires.numbers[place, DOF]], p)


def fastest(mechanics: Mechanics, spec: Spec) -> float:
    """Largest rate (rad/s) of the mechanics with contacts closed and wires taut."""
    return float(np.abs(modes(mechanics, spec)).max(initial=0.0))


def modes(mechanics: Mechanics, spec: Spec) -> np.ndarray:
    """Eigenvalues (rad/s) of the mechanics with contacts closed and wires taut."""
    a = mechanics.a.copy()
    n, m = mechanics.inverse_mass.shape[0], mechanics.stiffness.shape[0]
    for actuator in range(m):
        force = np.zeros(a.shape[0])
        force[mechanics.wires[actuator, DOF]] = -mechanics.stiffness[actuator, 0]
        a += np.outer(mechanics.b[:, m + n + actuator], force)
    for effect in spec.effects:
        if effect.block == "plant" and effect.dof and spec.plant:
            dof = spec.plant.dofs.index(effect.dof)
            stiffness, damping = effect.law.steepest(effect.numbers)
            a[n : 2 * n, dof] -= mechanics.inverse_mass[:, dof] * abs(stiffness)
            a[n : 2 * n, n + dof] -= mechanics.inverse_mass[:, dof] * damping
    return np.asarray(np.linalg.eigvals(a))
