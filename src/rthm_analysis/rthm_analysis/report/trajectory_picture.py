"""A simulated test as a picture: positions beside the ideal system's, forces and energies over time."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.report.colours import COLOURS, INK
from rthm_analysis.report.thinning import extremes
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_core.engine import Trajectory

DPI = 100
"""Pixels per inch of a PNG: as wide as a page on a screen, and small enough to send."""

PANELS = {
    "position (m)": {"plant_position": "plant", "numerical_position": "numerical"},
    "force (N)": {"actuator_force": "force in wire", "force_reference": "reference"},
}
"""Columns of a trajectory by the axis that they are drawn over, and their names."""


def draw(columns: Mapping[str, Floats], path: Path, ideal: Trajectory | None = None) -> None:
    """Write a PNG, SVG or PDF file.

    Parameters
    ----------
    columns : mapping of arrays
        As in the file of ``rthm simulate``: ``t`` (N,), motions and forces (N, n), energies ``E_...`` (N,).
    path : Path
    ideal : Trajectory, optional
        Motion of the ideal system, drawn beside that of the loop.
    """
    t = np.asarray(columns["t"])
    panels = {label: _curves(columns, names) for label, names in PANELS.items()}
    panels["energy (J)"] = {name: np.asarray(columns[name]) for name in columns if name.startswith("E_")}
    shown = {label: curves for label, curves in panels.items() if any(np.any(one) for one in curves.values())}
    write_panels(t, shown, path, ideal)


def write_panels(
    t: Floats, shown: Mapping[str, Mapping[str, Floats]], path: Path, ideal: Trajectory | None = None
) -> None:
    """Write panels, one below the other, by the label of their axis, each with its curves (N,) over `t`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 2.6 * len(shown)), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axis, (label, curves) in zip(axes, shown.items(), strict=True):
        _panel(axis, t, curves)
        if ideal is not None and label in PANELS:
            _beside(axis, ideal, PANELS[label], curves)
        axis.set_ylabel(label)
        axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=6, frameon=False, fontsize=8)
    axes[-1].set_xlabel("time (s)")
    figure.savefig(path, dpi=DPI)


def _curves(columns: Mapping[str, Floats], names: Mapping[str, str]) -> dict[str, Floats]:
    found = {}
    for name, words in names.items():
        values = np.atleast_2d(np.asarray(columns[name]).T) if name in columns else np.empty((0, 0))
        for k, one in enumerate(values, 1):
            found[words if len(values) == 1 else f"{words} {k}"] = one
    return found


def _panel(axis: Any, t: Floats, curves: Mapping[str, Floats]) -> None:
    for (name, values), colour in zip(curves.items(), (*COLOURS, INK) * 4, strict=False):
        if np.any(values):
            rows = extremes(values)
            axis.plot(t[rows], values[rows], color=colour, linewidth=1.1, label=name)
    axis.grid(color="#e3e7eb", linewidth=0.6)
    axis.margins(x=0.0)


def _beside(axis: Any, ideal: Trajectory, names: Mapping[str, str], shown: Mapping[str, Floats]) -> None:
    """Draw positions of the ideal system, below those of the loop and in their colours."""
    positions = {name: getattr(ideal, name) for name in names if name.endswith("position")}
    curves = _curves(positions, names)
    for (name, values), colour in zip(curves.items(), COLOURS * 4, strict=False):
        if name in shown and np.any(values):
            rows = extremes(values)
            axis.plot(
                ideal.t[rows],
                values[rows],
                color=colour,
                linewidth=1.0,
                linestyle=(0, (4, 2)),
                alpha=0.75,
                label=f"{name}, ideal",
                zorder=1.5,
            )
