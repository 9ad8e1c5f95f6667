"""A trajectory as a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.engine import Trajectory

MOTION = (
    "t",
    "plant_position",
    "plant_velocity",
    "numerical_position",
    "numerical_velocity",
    "force_reference",
    "actuator_force",
)
"""Arrays beside the energies; one row per instant, one column per degree of freedom or actuator."""


def save(trajectory: Trajectory, path: Path) -> None:
    """Write an npz file with the keys of the contract, section 5."""
    import numpy as np

    arrays = {name: getattr(trajectory, name) for name in MOTION} | all_energies(trajectory)
    with path.open("wb") as file:
        np.savez(file, **arrays)


def all_energies(trajectory: Trajectory) -> dict[str, Floats]:
    """Energies of a trajectory with ``E_err``, the sum of the three errors of the loop."""
    energies = dict(trajectory.energies)
    if energies and "E_err" not in energies:
        energies["E_err"] = energies["E_num"] + energies["E_ff"] + energies["E_fx"]
    return energies
