"""What was recorded of a plant as a picture: one panel for each quantity."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.exchange.mapping import ROLES
from rthm_analysis.recording import Table
from rthm_analysis.report.trajectory_picture import write_panels
from rthm_core.clock import NS
from rthm_core.topics import ACCELERATION, PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

PANELS = {
    (PLANT_STATE, "position"): ("position", "m"),
    (PLANT_STATE, "velocity"): ("velocity", "m/s"),
    (ACCELERATION, "effort"): ("acceleration", "m/s^2"),
    (PLANT_STATE, "effort"): ("force", "N"),
}
"""Topics and fields, what they are called, and their units."""


def draw(tables: Mapping[str, Table], units: Mapping[tuple[str, str], str], path: Path) -> None:
    """Write a PNG, SVG or PDF file.

    Parameters
    ----------
    tables : mapping
        Samples of the plant by topic.
    units : mapping
        Units by role and name, where they are not those of the contract.
    path : Path
    """
    turning = {(ROLES[role].topic, ROLES[role].field): unit for (role, _), unit in units.items()}
    panels = {}
    for (topic, field), (words, unit) in PANELS.items():
        if (table := tables.get(topic)) is None:
            continue
        columns = getattr(table, field).T
        curves = {n: one for n, one in zip(table.names, columns, strict=True) if np.isfinite(one).any()}
        if curves:
            panels[f"{words} ({turning.get((topic, field), unit)})"] = curves
    write_panels(_seconds(tables[PLANT_STATE]), panels, path)


def _seconds(table: Table) -> Floats:
    return np.asarray((table.stamp_ns - table.stamp_ns[0]) / NS)
