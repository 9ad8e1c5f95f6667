"""A trajectory: what the simulation of a test gives."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.energy import TERMS, with_error
from rthm_core.engine.linear.blocks import Rows

if TYPE_CHECKING:
    from rthm_core.spec import Spec


@dataclass
class Trajectory:
    """True motion of a simulated test at the instants `t` (s, N of them); SI units.

    Attributes
    ----------
    plant_position, plant_velocity, numerical_position, numerical_velocity : (N, n) arrays
    force_reference, actuator_force : (N, m) arrays
        F_d in use by the controller, and the force in the wire.
    energies : dict of (N,) arrays
        Work and E_total of the contract, section 1; empty when they were not counted.
    """

    t: Floats
    plant_position: Floats
    plant_velocity: Floats
    numerical_position: Floats
    numerical_velocity: Floats
    force_reference: Floats
    actuator_force: Floats
    energies: dict[str, Floats] = field(default_factory=dict)

    @property
    def balance_error(self) -> Floats:
        """E_total - E_total(0) - sum of all work, in J (N,)."""
        return np.asarray(
            self.energies["E_total"]
            - self.energies["E_total"][0]
            - sum(self.energies[term] for term in TERMS)
        )

    def all_energies(self) -> dict[str, Floats]:
        """Energies with ``E_err``, the sum of the three errors of the loop; empty when none were counted."""
        return with_error(self.energies)


def of_rows(spec: Spec, rows: Rows, step: int, first_row: int = 0) -> Trajectory:
    """Trajectory of the rows of a loop, `step` ns apart."""
    n1, n2 = len(spec.plant.dofs), rows.numerical.shape[1] // 2
    return Trajectory(
        np.arange(first_row, first_row + rows.plant.shape[0], dtype=float) * (step * 1e-9),
        rows.plant[:, :n1],
        rows.plant[:, n1 : 2 * n1],
        rows.numerical[:, :n2],
        rows.numerical[:, n2:],
        rows.reference,
        rows.plant[:, 2 * n1 :],
        dict(zip((*TERMS, "E_total"), rows.work.T, strict=False)) if rows.work.size else {},
    )


def of_columns(
    rows: Floats, step: int, n1: int, n2: int, m: int, *, energies: bool, first_row: int = 0
) -> Trajectory:
    """Trajectory of rows [x1, v1, x2, v2, F_d, F, work, E_total], `step` ns apart."""
    x1, v1, x2, v2, reference, force, work, total = np.split(
        rows, np.cumsum([n1, n1, n2, n2, m, m, 6]), axis=1
    )
    found = dict(zip(TERMS, work.T, strict=True)) | {"E_total": total[:, 0]} if energies else {}
    return Trajectory(
        np.arange(first_row, first_row + rows.shape[0], dtype=float) * (step * 1e-9),
        x1,
        v1,
        x2,
        v2,
        reference,
        force,
        found,
    )
