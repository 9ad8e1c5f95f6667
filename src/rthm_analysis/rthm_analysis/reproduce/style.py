"""One look for all figures: single-column width, one colour and one dash for each thing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.typing import RcKeyType

WIDTH, DOUBLE = 3.4, 7.0
"""Widths of one and of two columns, in."""

IDEAL: dict[str, Any] = {"color": "#222222", "linestyle": (0, (4, 2)), "linewidth": 1.0}
HYBRID: dict[str, Any] = {"color": "#0072b2", "linewidth": 1.3}
TAYLOR: dict[str, Any] = {"color": "#d55e00", "linestyle": (0, (1.2, 1.2)), "linewidth": 1.3}
POLYNOMIAL: dict[str, Any] = {"color": "#009e73", "linewidth": 1.2}
OTHER_SET: dict[str, Any] = {"color": "#9aa5b1", "linewidth": 0.5, "alpha": 0.85}
BAND: dict[str, Any] = {"alpha": 0.18, "linewidth": 0}
TERM_COLOURS = {
    "E_fx": "#0072b2",
    "E_ff": "#e69f00",
    "E_num": "#009e73",
    "E_damping": "#8c8c8c",
    "E_err": "#cc79a7",
    "E_total": "#222222",
}
TERM_NAMES = {
    "E_fx": r"$\Delta E_{fx}$",
    "E_ff": r"$\Delta E_{ff}$",
    "E_num": r"$\Delta E_{num}$",
    "E_damping": r"$\Delta E_{damp}$",
    "E_err": r"$\Delta E_{err}$",
    "E_total": r"$E_{total}$",
}
SHADES = ("#222222", "#6baed6", "#3182bd", "#08519c", "#081d58")
"""From no delay to the longest."""

LOOK: dict[RcKeyType, Any] = {
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
    "axes.titlelocation": "left",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e3e7eb",
    "grid.linewidth": 0.5,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 6.8,
    "legend.frameon": False,
    "legend.handlelength": 2.0,
    "legend.columnspacing": 1.2,
    "legend.borderaxespad": 0.2,
    "svg.fonttype": "path",
    "svg.hashsalt": "rthm",
    "figure.dpi": 150,
}


def panels(
    rows: int, columns: int = 1, *, height: float, width: float = WIDTH, **options: Any
) -> tuple[Figure, Any]:
    """Figure and its axes, (rows, columns); sizes in inches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.03, h_pad=0.03)  # type: ignore[union-attr,call-arg]
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def over_time(axes: Axes, duration: float) -> None:
    """Time axis from 0 to `duration` (s), a tick every fourth of it."""
    axes.set(xlabel="time  (s)", xlim=(0.0, duration), xticks=[0.25 * k * duration for k in range(5)])


def legend_above(axes: Axes, columns: int = 3, **options: Any) -> None:
    """Legend over the axes, so that it hides no curve."""
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.01), ncols=columns, **options)


def save(figure: Figure, path: Path) -> None:
    """Write PNG (300 dpi) and SVG beside each other; the same numbers give the same bytes."""
    figure.savefig(path.with_suffix(".png"), dpi=300, metadata={"Software": None})
    figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})
