"""What the recorded motion says of the plant: the mass, damping and stiffness that its forces ask for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import FREE_MOTION_FORCE_RATIO, TELLING_FORCE_RATIO
from rthm_analysis.diagnosis.faults.relations import related, wires_of
from rthm_analysis.diagnosis.faults.smooth import Smooth

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class PlantSeen:
    """A plant of one dof as the recorded motion has it.

    Attributes
    ----------
    mass, stiffness : float or None
        Over the spec's; None where the motion does not tell it, or the spec has none.
    correlation : float
        Between the known force and what mass, damping and stiffness of any size make of the motion.
    frequency : float or None
        Natural frequency over the spec's.
    """

    mass: float | None
    stiffness: float | None
    correlation: float
    frequency: float | None

    @property
    def told(self) -> list[float]:
        """Ratios that the motion tells."""
        return [one for one in (self.mass, self.stiffness) if one is not None]


def known_force(smooth: Smooth, spec: Spec) -> Floats:
    """Known force on the only dof (p,): its load, and the forces in wires where commands drive the plant."""
    assert spec.plant is not None
    dof = spec.plant.dofs[0]
    force = smooth.values["load", dof].copy()
    if any(family == "command" for family, _ in smooth.values):
        for wire in wires_of(spec):
            force += smooth.values["force", wire.actuator]
    return force


def plant_seen(smooth: Smooth, spec: Spec) -> PlantSeen | None:
    """Plant of one dof from a regression of the known force on the motion; None where there is none to ask.

    Parameters
    ----------
    smooth : Smooth
        With the position of the dof, and the forces in all wires where commands drive the plant.
    spec : Spec
    """
    assert spec.plant is not None
    (dof, *others), at = spec.plant.dofs, ("position", spec.plant.dofs[0])
    missing = any(
        ("force", wire.actuator) not in smooth.values
        for wire in wires_of(spec)
        if ("command", wire.actuator) in smooth.values
    )
    if others or missing or at not in smooth.values or ("load", dof) not in smooth.values:
        return None
    x, v, a = smooth.values[at], smooth.rates[at], smooth.seconds[at]
    force = known_force(smooth, spec)
    mass, stiffness = spec.plant.mass[0], spec.plant.stiffness[0]
    columns = np.column_stack([a, v, x])
    columns, wanted = columns - columns.mean(axis=0), force - force.mean()
    size = np.sqrt(np.mean(np.square(columns), axis=0))
    needed = mass * size[0] + stiffness * size[2]
    strength = float(np.sqrt(np.mean(np.square(wanted))))
    if not (size > 0.0).all() or not strength > FREE_MOTION_FORCE_RATIO * needed:
        return None
    found = np.linalg.lstsq(columns / size, wanted, rcond=None)[0] / size
    telling = np.abs(found) * size > TELLING_FORCE_RATIO * strength
    ratios = [
        float(value / nominal) if told and nominal > 0.0 else None
        for value, nominal, told in zip(found[[0, 2]], (mass, stiffness), telling[[0, 2]], strict=True)
    ]
    both = ratios[0] is not None and ratios[1] is not None and ratios[0] * ratios[1] > 0.0
    frequency = float(np.sqrt(ratios[1] / ratios[0])) if both else None  # type: ignore[operator]
    return PlantSeen(ratios[0], ratios[1], related(columns @ found, wanted)[1], frequency)
