"""A frequency response as a Bode plot: amplitude and phase of every way of computing it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_analysis.response.result import Response

LOOKS: dict[str, dict[str, Any]] = {
    "ideal": {"color": "#222222", "linestyle": (0, (4, 2)), "linewidth": 1.2},
    "delays": {"color": "#9aa5b1", "linewidth": 1.2},
    "delays_and_holds": {"color": "#009e73", "linewidth": 1.2},
    "taylor": {"color": "#d55e00", "linestyle": (0, (1.2, 1.2)), "linewidth": 1.4},
    "sampled": {"color": "#0072b2", "linewidth": 1.8},
}

FEWEST = 3
"""Frequencies from which there is a curve."""


def draw(result: Response, margin: str, path: Path) -> None:
    """Write a PNG, SVG or PDF file.

    Parameters
    ----------
    result : Response
        The load is on its first dof; there is a column for the motion of each.
    margin : str
        How far the loop is from the edge of stability, in a sentence.
    path : Path

    Raises
    ------
    InputError
        There are too few frequencies for a curve.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    if result.omega.size < FEWEST:
        raise InputError(
            f"--plot has {result.omega.size} frequencies to draw, but a curve takes {FEWEST}; give a range, "
            "as --omega 0.5:20:200."
        )
    count = len(result.dofs)
    figure = Figure(figsize=(max(6.4, 4.4 * count), 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, count, sharex=True, squeeze=False, height_ratios=(3, 2))
    for column, dof in enumerate(result.dofs):
        _column(axes[:, column], result, column)
        axes[0, column].set_title(f"load on {result.dofs[0]}, motion of {dof}", loc="left", fontsize=10)
    axes[0, 0].set_ylabel("amplitude (m/N)")
    axes[1, 0].set_ylabel("phase (deg)")
    handles, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=len(LOOKS), frameon=False)
    figure.suptitle(margin, fontsize=10)
    figure.savefig(path, dpi=150)


def _column(axes: Any, result: Response, output: int) -> None:
    order = np.argsort(result.omega)
    omega = result.omega[order]
    for way, look in LOOKS.items():
        values = result.ways[way][order, output, 0]
        axes[0].loglog(omega, np.abs(values), label=way.replace("_", " "), **look)
        axes[1].semilogx(omega, np.degrees(np.unwrap(np.angle(values))), **look)
    for axis in axes:
        axis.grid(color="#e3e7eb", linewidth=0.6, which="both")
        axis.margins(x=0.0)
    axes[1].set_xlabel("frequency (rad/s)")
