"""Systems without a loop: a plant alone, the ideal system, and its first-order approximation.

The ideal system is (9): both substructures joined by the interface itself. The approximation is (25) with the
corrected (26). Both are a plant of
n1 + n2 dofs without actuators, with the plant's effects where they were.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_core.compiled import Floats, compiled_in_place
from rthm_core.energy import TERMS, delay_matrices
from rthm_core.engine.exponential import exponentials
from rthm_core.engine.linear_loop import Exosystem, exosystem, with_loads
from rthm_core.errors import InputError
from rthm_core.loads import Load, load
from rthm_core.physical.advance import Physical, advance_physical, listed_loads, physical
from rthm_core.physical.model import physical_model
from rthm_core.substructure import Substructure, interface, substructure

if TYPE_CHECKING:
    from rthm_core.engine.simulate import Trajectory
    from rthm_core.spec import Spec


def coupled_body(spec: Spec, system: str) -> Substructure:
    """Mass, damping and stiffness of the ideal system or of its first-order approximation; plant dofs
    first.
    """
    one, two, sides = substructure(spec.plant), substructure(spec.loop().numerical), interface(spec)
    n1, n2 = one.dofs, two.dofs
    mass, damping, stiffness = (np.zeros((n1 + n2, n1 + n2)) for _ in range(3))
    for joint, first, second in (
        (mass, one.mass, two.mass),
        (damping, one.damping, two.damping),
        (stiffness, one.stiffness, two.stiffness),
    ):
        joint[:n1, :n1], joint[n1:, n1:] = first, second
    for a in range(sides.actuators):
        stretch = np.zeros(n1 + n2)
        stretch[sides.plant[a]], stretch[n1 + sides.numerical[a]] = 1.0, -1.0
        stiffness += sides.stiffness[a] * np.outer(stretch, stretch)
        damping += sides.damping[a] * np.outer(stretch, stretch)
    if system == "taylor":
        added_mass, added_damping = delay_matrices(spec)
        mass, damping = mass + added_mass, damping + added_damping
    return Substructure(
        mass,
        damping,
        stiffness,
        np.concatenate([one.position, two.position]),
        np.concatenate([one.velocity, two.velocity]),
    )


def _further_load(spec: Spec) -> list[tuple[Load, int]]:
    """Load on the numerical dofs, where they stand in the coupled system."""
    section, n1 = spec.load.numerical, len(spec.plant.dofs)
    if section is None or section.kind == "none":
        return []
    return [(load(section), n1 + spec.loop().numerical.dofs.index(section.dof))]


@compiled_in_place
def _rows(side: Physical, step: int, out: Floats, listed: Floats) -> None:
    for row in range(out.shape[0]):
        advance_physical(side, row * step)
        for i in range(out.shape[1]):
            out[row, i] = side.state.y[i]
        listed_loads(side, listed[row])


BLOCK = 64
"""Rows of a linear system that are made of one."""


def _linear_rows(side: Physical, loads: Exosystem, count: int, step: int) -> Floats:
    """Rows (count, .) of a linear system with the loads as states: blocks of matrices, no step after step."""
    linear = with_loads(side.model.whole.ab, side.state.y, np.empty(0), loads)
    steps = exponentials(linear.a, np.arange(BLOCK + 1) * step)
    across = steps[:BLOCK].reshape(-1, linear.a.shape[0])
    begins = np.empty((-(-count // BLOCK), linear.a.shape[0]))
    begins[0] = linear.state(0.0)
    for block in range(1, begins.shape[0]):
        begins[block] = steps[BLOCK] @ begins[block - 1]
    return np.asarray((begins @ across.T).reshape(-1, linear.a.shape[0])[:count])


def simulate_coupled(spec: Spec, end: int, step: int, system: str, *, energies: bool) -> Trajectory:
    """Trajectory of a plant alone (``"hybrid"`` of a spec without loop), of the ideal system or of its
    approximation, every `step` ns.
    """
    from rthm_core.engine.simulate import (
        Trajectory,
    )  # the one public result type lives beside the verb that gives it

    if system != "hybrid" and not spec.is_loop:
        raise InputError(
            f"system {system!r} needs a whole loop, but the spec has a plant alone; add the "
            f"other sections or choose the system hybrid."
        )
    body = substructure(spec.plant) if not spec.is_loop else coupled_body(spec, system)
    further = _further_load(spec) if spec.is_loop else []
    model, resting = physical_model(spec, body=body, further=further)
    side = physical(model, resting, body.position, body.velocity, np.empty(0))
    loads = exosystem(model.loads)
    if model.laws is None and loads is not None:
        out = _linear_rows(side, loads, end // step + 1, step)[:, : 2 * body.dofs]
    else:
        out, listed = np.zeros((end // step + 1, 2 * body.dofs)), np.zeros((end // step + 1, body.dofs))
        _rows(side, step, out, listed)
    x, v = out[:, : body.dofs], out[:, body.dofs :]
    n1 = len(spec.plant.dofs)
    force = _interface_forces(spec, x, v) if spec.is_loop else np.zeros((out.shape[0], 0))
    return Trajectory(
        np.asarray(np.arange(out.shape[0]) * step * 1e-9, dtype=float),
        x[:, :n1],
        v[:, :n1],
        x[:, n1:],
        v[:, n1:],
        force,
        force.copy(),
        _energies(spec, body, x, v) if energies else {},
    )


def _interface_forces(spec: Spec, x: Floats, v: Floats) -> Floats:
    sides, n1 = interface(spec), len(spec.plant.dofs)
    two = n1 + sides.numerical
    return -sides.damping * (v[:, sides.plant] - v[:, two]) - sides.stiffness * (
        x[:, sides.plant] - x[:, two]
    )


def _energies(spec: Spec, body: Substructure, x: Floats, v: Floats) -> dict[str, Floats]:
    """Total energy; the works of a loop that is not there are zero, and the others are not counted here
    (nan).
    """
    total = 0.5 * (np.einsum("ti,ij,tj->t", v, body.mass, v) + np.einsum("ti,ij,tj->t", x, body.stiffness, x))
    return {
        term: np.zeros(x.shape[0]) if term in ("E_num", "E_ff", "E_fx") else np.full(x.shape[0], np.nan)
        for term in TERMS
    } | {"E_total": total}
