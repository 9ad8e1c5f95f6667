"""A sweep as a picture: lines over one key, maps over two, points over more."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.sweep.folder import column
from rthm_analysis.sweep.labels import label
from rthm_analysis.sweep.ranges import Range
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pyarrow

    Nominal = Sequence[float | None]

SHOWN = {
    "growth_rate": "growth rate (1/s)",
    "damping_ratio": "damping ratio (1)",
    "E_err": "energy brought in (J)",
    "equivalent_damping": "equivalent damping (N s/m)",
    "max_error": "largest error of x1 (m)",
    "E_total": "energy left (J)",
}
"""Quantities in a picture, and the words beside them."""

OF_STABLE = ("E_err", "equivalent_damping", "max_error", "E_total")
"""Quantities that grow without bound where a loop is unstable, and say nothing there."""

UNSTABLE = "#f3d9d2"


def draw(
    table: pyarrow.Table, ranges: list[Range], path: Path, *, drawn: bool, nominal: Nominal = ()
) -> None:
    """Write a picture (PNG, SVG or PDF by the name's end) of a sweep.

    Parameters
    ----------
    drawn : bool
        Over random draws.
    nominal : sequence of float or None
        What the spec itself has, by range; it is marked.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    growth = column(table, "growth_rate")
    told = quantities(table)
    shown = {name: words for name, words in SHOWN.items() if np.isfinite(told[name]).any()}
    nominal = tuple(nominal) or (None,) * len(ranges)
    points = drawn or len(ranges) > 2
    rows, columns = (len(shown), len(ranges)) if points else (-(-len(shown) // 2), min(2, len(shown)))
    figure = Figure(figsize=(4.6 * columns, 3.0 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    axes = np.atleast_1d(figure.subplots(rows, columns, squeeze=False))
    for k, (name, words) in enumerate(shown.items()):
        values = told[name]
        if points:
            _points(axes[k], table, ranges, values, words)
        elif len(ranges) == 1:
            x = column(table, ranges[0].key)
            _line(axes.flat[k], x, values, ranges[0], words)
            _mark_line(axes.flat[k], x, growth, nominal[0])
        else:
            _map(figure, axes.flat[k], ranges, values, growth, words)
            if None not in nominal:
                axes.flat[k].plot(*nominal, "+", color="black", markersize=9, markeredgewidth=1.6)
    for unused in axes.flat[len(shown) :] if not points else []:
        unused.set_visible(False)
    figure.suptitle(f"{table.num_rows} loops; {_legend(points, ranges)}")
    figure.savefig(path, dpi=150)


def quantities(table: pyarrow.Table) -> dict[str, Floats]:
    """What is drawn, (loops,) each; NaN where a loop is unstable and the quantity says nothing there."""
    told, stable = {name: column(table, name) for name in SHOWN}, column(table, "growth_rate") < 0.0
    if not stable.any():
        return told
    return told | {name: np.where(stable, told[name], np.nan) for name in OF_STABLE}


def _legend(points: bool, ranges: list[Range]) -> str:
    if points:
        return "blue: stable, red: not"
    if len(ranges) == 1:
        return "shaded: unstable; dashed: the spec"
    return "black line: edge of stability; grey: unstable; +: the spec"


def _mark_line(axis: Any, x: Floats, growth: Floats, nominal: float | None) -> None:
    """Shade where the loop is unstable, and mark where the spec is."""
    order = np.argsort(x)
    axis.fill_between(
        x[order],
        0.0,
        1.0,
        where=growth[order] >= 0.0,
        transform=axis.get_xaxis_transform(),
        color=UNSTABLE,
        linewidth=0,
        zorder=0,
    )
    if nominal is not None:
        axis.axvline(nominal, color="black", linewidth=0.9, linestyle=(0, (4, 3)))


def _line(axis: Any, x: Floats, y: Floats, over: Range, words: str) -> None:
    axis.plot(x, y, color="#1f4e79", marker="." if x.size < 60 else "", linewidth=1.2)
    axis.axhline(0.0, color="#999999", linewidth=0.6)
    if over.log:
        axis.set_xscale("log")
    axis.set(xlabel=label(over.key), ylabel=words)


def _map(figure: Any, axis: Any, ranges: list[Range], z: Floats, growth: Floats, words: str) -> None:
    first, second = ranges
    shape = (first.values.size, second.values.size)
    grid, edge = z.reshape(shape).T, growth.reshape(shape).T
    limit = np.nanquantile(np.abs(z[np.isfinite(z)]), 0.98) or 1.0
    signed = np.nanmin(z) < 0.0
    mesh = axis.pcolormesh(
        first.values,
        second.values,
        grid,
        shading="nearest",
        cmap="RdBu_r" if signed else "viridis",
        vmin=-limit if signed else 0.0,
        vmax=limit,
        rasterized=True,
    )
    figure.colorbar(mesh, ax=axis, label=words)
    if min(shape) > 1 and np.nanmin(edge) < 0.0 < np.nanmax(edge):
        axis.contour(first.values, second.values, edge, levels=[0.0], colors="black", linewidths=1.4)
    for one, scale in ((first, axis.set_xscale), (second, axis.set_yscale)):
        if one.log:
            scale("log")
    axis.set_facecolor("#d9dde2")
    axis.set(xlabel=label(first.key), ylabel=label(second.key))


def _points(axes: Any, table: pyarrow.Table, ranges: list[Range], y: Floats, words: str) -> None:
    stable = column(table, "growth_rate") < 0.0
    for axis, one in zip(axes, ranges, strict=True):
        x = column(table, one.key)
        axis.plot(x[stable], y[stable], ".", markersize=2.5, color="#1f4e79", label="stable")
        axis.plot(x[~stable], y[~stable], ".", markersize=2.5, color="#c0392b", label="not stable")
        if one.log:
            axis.set_xscale("log")
        axis.set(xlabel=label(one.key), ylabel=words)
