"""What was recorded of a plant as a picture: one panel for positions, one for velocities, one for forces."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.exchange.mapping import ROLES
from rthm_analysis.recording import Table
from rthm_analysis.report.trajectory_picture import write_panels
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

FIELDS = {"position": ("position", "m"), "velocity": ("velocity", "m/s"), "effort": ("force", "N")}
"""Fields of a table, what they are called, and their units."""


def draw(table: Table, units: Mapping[tuple[str, str], str], path: Path) -> None:
    """Write a PNG, SVG or PDF file.

    Parameters
    ----------
    table : Table
        Samples of the plant.
    units : mapping
        Units by role and name, where they are not those of the contract.
    path : Path
    """
    turning = {ROLES[role].field: unit for (role, _), unit in units.items()}
    panels = {}
    for field, (words, unit) in FIELDS.items():
        columns = getattr(table, field).T
        curves = {n: one for n, one in zip(table.names, columns, strict=True) if np.isfinite(one).any()}
        if curves:
            panels[f"{words} ({turning.get(field, unit)})"] = curves
    write_panels(_seconds(table), panels, path)


def _seconds(table: Table) -> Floats:
    return np.asarray((table.stamp_ns - table.stamp_ns[0]) / NS)
