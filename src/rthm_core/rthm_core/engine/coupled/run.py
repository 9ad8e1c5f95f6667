"""Trajectory of a system without a loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.energy import GAUSS_NODES
from rthm_core.engine.coupled.body import coupled_body, further_load
from rthm_core.engine.coupled.energies import energies_of
from rthm_core.engine.coupled.motion import motions
from rthm_core.engine.trajectory import Trajectory
from rthm_core.errors import InputError
from rthm_core.physical.model import physical_model
from rthm_core.physical.start import physical
from rthm_core.substructure import interface, substructure

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def simulate_coupled(spec: Spec, end: int, step: int, system: str, *, energies: bool) -> Trajectory:
    """Trajectory of a plant alone (``"hybrid"`` of a spec without loop), of the ideal system or of its
    approximation, every `step` ns.
    """
    if system != "hybrid" and not spec.is_loop:
        raise InputError(
            f"system {system!r} needs a whole loop, but the spec has a plant alone; add the "
            f"other sections or choose the system hybrid."
        )
    body = substructure(spec.plant) if not spec.is_loop else coupled_body(spec, system)
    further = further_load(spec) if spec.is_loop else []
    model, resting = physical_model(spec, body=body, further=further)
    side = physical(model, resting, body.position, body.velocity, np.empty(0))
    offsets = np.rint(GAUSS_NODES * step).astype(np.int64) if energies else np.empty(0, dtype=np.int64)
    rows, *between = motions(side, end // step + 1, step, offsets)
    n1 = len(spec.plant.dofs)
    force = _interface_forces(spec, rows.x, rows.v) if spec.is_loop else np.zeros((rows.x.shape[0], 0))
    return Trajectory(
        np.asarray(np.arange(rows.x.shape[0]) * step * 1e-9, dtype=float),
        rows.x[:, :n1],
        rows.v[:, :n1],
        rows.x[:, n1:],
        rows.v[:, n1:],
        force,
        force.copy(),
        energies_of(spec, system, body, rows, between, step, smooth=model.laws is None) if energies else {},
    )


def _interface_forces(spec: Spec, x: Floats, v: Floats) -> Floats:
    sides, n1 = interface(spec), len(spec.plant.dofs)
    two = n1 + sides.numerical
    return -sides.damping * (v[:, sides.plant] - v[:, two]) - sides.stiffness * (
        x[:, sides.plant] - x[:, two]
    )
