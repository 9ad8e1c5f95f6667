"""Both substructures as one, joined by the interface or by what the loop makes of it to first order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_core.energy import delay_matrices
from rthm_core.loads import Load, load
from rthm_core.substructure import Substructure, interface, substructure

if TYPE_CHECKING:
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


def further_load(spec: Spec) -> list[tuple[Load, int]]:
    """Load on the numerical dofs, where they stand in the coupled system."""
    section, n1 = spec.load.numerical, len(spec.plant.dofs)
    if section is None or section.kind == "none":
        return []
    return [(load(section), n1 + spec.loop().numerical.dofs.index(section.dof))]
