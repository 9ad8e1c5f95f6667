"""A frequency response as a Bode plot: amplitude and phase of every way of computing it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_analysis.response.result import Response
    from rthm_core.compiled import Floats

LOOKS: dict[str, dict[str, Any]] = {
    "ideal": {"color": "#222222", "linestyle": (0, (4, 2)), "linewidth": 1.2},
    "delays": {"color": "#9aa5b1", "linewidth": 1.2},
    "delays_and_holds": {"color": "#009e73", "linewidth": 1.2},
    "taylor": {"color": "#d55e00", "linestyle": (0, (1.2, 1.2)), "linewidth": 1.4},
    "sampled": {"color": "#0072b2", "linewidth": 1.8},
}

EDGE, MARGIN = "#222222", "#d55e00"

FEWEST_FREQUENCIES = 3
"""Frequencies from which there is a curve."""


def draw(result: Response, margin: str, path: Path) -> None:
    """Write a PNG, SVG or PDF file.

    Parameters
    ----------
    result : Response
        The load is on its first dof; there is a column for the motion of each, and one for each motor.
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

    if result.omega.size < FEWEST_FREQUENCIES:
        raise InputError(
            f"--plot has {result.omega.size} frequencies to draw, but a curve takes "
            f"{FEWEST_FREQUENCIES}; give a range, as --omega 0.5:20:200."
        )
    count = len(result.dofs) + len(result.margins)
    figure = Figure(figsize=(max(6.4, 4.4 * count), 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, count, sharex=True, squeeze=False, height_ratios=(3, 2))
    for column, dof in enumerate(result.dofs):
        _column(axes[:, column], result, column)
        axes[0, column].set_title(f"load on {result.dofs[0]}, motion of {dof}", loc="left", fontsize=10)
    for column in range(len(result.margins)):
        _loop(axes[:, len(result.dofs) + column], result, column)
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
    _finish(axes)


def _finish(axes: Any) -> None:
    for axis in axes:
        axis.grid(color="#e3e7eb", linewidth=0.6, which="both")
        axis.margins(x=0.0)
    axes[1].set_xlabel("frequency (rad/s)")


def _loop(axes: Any, result: Response, motor: int) -> None:
    """Loop transfer, cut at the command of a motor; the edge of stability is at 1 and 0 deg."""
    assert result.loop_transfer is not None
    order = np.argsort(result.omega)
    omega, values = result.omega[order], result.loop_transfer[order, motor]
    phase = np.degrees(np.angle(values))
    phase[1:][np.abs(np.diff(phase)) > 180.0] = np.nan  # a jump of a whole turn is none
    axes[0].loglog(omega, np.abs(values), **LOOKS["delays_and_holds"])
    axes[1].semilogx(omega, phase, **LOOKS["delays_and_holds"])
    axes[0].axhline(1.0, color=EDGE, linewidth=0.8)
    axes[1].axhline(0.0, color=EDGE, linewidth=0.8)
    margins = result.margins[motor]
    for edge in filter(None, (margins.gain_below, margins.gain)):
        _arrow(axes[0], omega, edge.omega, 1.0 / edge.value, 1.0)
    if margins.phase:
        _arrow(axes[1], omega, margins.phase.omega, np.degrees(margins.phase.value), 0.0)
    if margins.delay:
        lag = np.angle(np.exp(1j * margins.delay.omega * margins.delay.value), deg=True)
        _arrow(axes[1], omega, margins.delay.omega, lag, 0.0)
    told = zip(("gain margin", "phase margin", "delay margin"), margins.words, strict=True)
    words = [
        f"loop opened at the command of {margins.actuator}",
        *(f"{name} {value}" for name, value in told),
    ]
    axes[0].set_title("\n".join(words), loc="left", fontsize=10)
    axes[0].set_ylabel("loop transfer (1)")
    axes[1].set_ylabel("phase (deg)")
    _finish(axes)


def _arrow(axis: Any, omega: Floats, at: float, begin: float, end: float) -> None:
    """Margin as a line from the curve to the edge, where it is among the frequencies."""
    if omega[0] <= at <= omega[-1]:
        axis.plot([at, at], [begin, end], color=MARGIN, linewidth=2.2, marker="o", markersize=4)
