"""A stability map as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from rthm_analysis.sweep.labels import label
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rthm_analysis.stability.map import StabilityMap

LABELLED = 0.03
"""Part of a map from which a region has room for its name."""


def draw(over: StabilityMap, nominal: tuple[float | None, float | None], path: Path) -> None:
    """Write the map to a PNG, SVG or PDF file; `nominal`: where the spec itself is."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import SymLogNorm
    from matplotlib.figure import Figure

    first, second = over.ranges
    rate = over.growth_rate.T
    figure = Figure(figsize=(7.0, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    axis = figure.subplots()
    limit = float(np.nanquantile(np.abs(rate), 0.99)) or 1.0
    norm = SymLogNorm(limit / 50.0, vmin=-limit, vmax=limit)
    mesh = axis.pcolormesh(
        first.values, second.values, rate, shading="nearest", cmap="RdBu_r", norm=norm, rasterized=True
    )
    figure.colorbar(mesh, ax=axis, label="growth rate (1/s); below zero: stable")
    if min(rate.shape) > 1 and rate.min() < 0.0 < rate.max():
        bent = np.arcsinh(rate / (limit / 50.0))  # steep on one side and flat on the other would be jagged
        axis.contour(first.values, second.values, bent, levels=[0.0], colors="black", linewidths=1.5)
    if None not in nominal:
        place = cast("tuple[float, float]", nominal)
        axis.plot(*place, marker="+", color="black", markersize=11, markeredgewidth=1.8, clip_on=False)
    _name_regions(axis, first.values, second.values, rate)
    title = "black line: edge of stability; +: the spec"
    axis.set(xlabel=label(first.key), ylabel=label(second.key), title=title)
    for one, scale in ((first, axis.set_xscale), (second, axis.set_yscale)):
        if one.log:
            scale("log")
    figure.savefig(path, dpi=160)


def _name_regions(axis: Any, x: Floats, y: Floats, rate: Floats) -> None:
    """Write what each side of the edge is, at the middle of the largest rectangle around a point of it."""
    for words, inside in (("stable", rate < 0.0), ("unstable", rate > 0.0)):
        if inside.mean() < LABELLED:
            continue
        row, column = np.unravel_index(np.argmax(_depth(inside)), inside.shape)
        box = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "boxstyle": "round"}
        axis.text(x[column], y[row], words, ha="center", va="center", bbox=box)


def _depth(inside: NDArray[np.bool_]) -> Floats:
    """For every point, the steps to the nearest point that is outside, borders included."""
    depth = np.zeros(inside.shape)
    while inside.any():
        depth += inside
        wide = np.pad(inside, 1)
        inside = inside & wide[2:, 1:-1] & wide[:-2, 1:-1] & wide[1:-1, 2:] & wide[1:-1, :-2]
    return depth
