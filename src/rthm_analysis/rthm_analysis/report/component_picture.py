"""A component as a picture: its force over displacement, speed and time, measured and as found."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.report.colours import COLOURS, INK
from rthm_analysis.report.thinning import extremes
from rthm_analysis.report.trajectory_picture import DPI

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rthm_analysis.component import ComponentFinding, ComponentTest
    from rthm_analysis.component.fitting import Fitted
    from rthm_core.compiled import Floats

LOOP_PERIODS = 8.0
"""Periods of the motion whose loops are drawn: more is a blot."""

MEASURED = {"color": INK, "linewidth": 2.0, "alpha": 0.35, "label": "measured"}
FOUND = {"color": COLOURS[0], "linewidth": 0.9, "label": "as found"}
"""How curves look; the measured one is seen below the other."""


def draw(finding: ComponentFinding, model: Fitted, test: ComponentTest, path: Path) -> None:
    """Write a PNG, SVG or PDF file of the `picture`."""
    picture(finding, model, test).savefig(path, dpi=DPI)


def picture(finding: ComponentFinding, model: Fitted, test: ComponentTest) -> Figure:
    """Draw loops, force over time, and what is left.

    Parameters
    ----------
    finding : ComponentFinding
    model : Fitted
        What was found; drawn where it explains or improves something.
    test : ComponentTest
        The recording that confirms it.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplot_mosaic([["x", "v"], ["t", "t"], ["left", "left"]], height_ratios=(2.0, 1.2, 1.0))
    predicted = model.force(test) if finding.verdict != "unexplained" else None
    _loop(panels["x"], test, test.x, predicted, f"displacement of {finding.motion} (m)")
    _loop(panels["v"], test, test.v, predicted, f"speed of {finding.motion} (m/s)")
    for name in ("x", "t"):
        panels[name].set_ylabel(f"force {finding.force} (N)")
    _over_time(panels["t"], test.t, test.force, MEASURED)
    if predicted is not None:
        _over_time(panels["t"], test.t, predicted, FOUND)
        _over_time(panels["left"], test.t, test.force - predicted, {**FOUND, "color": INK, "label": "left"})
    panels["t"].legend(frameon=False, fontsize=8, ncols=2, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    panels["left"].set_ylabel("what is left (N)")
    panels["left"].set_xlabel("time (s)")
    return figure


def _loop(axis: Any, test: ComponentTest, over: Floats, predicted: Floats | None, label: str) -> None:
    period = 2.0 * np.pi * float(np.std(test.x)) / max(float(np.std(test.v)), 1e-300)
    rows = test.t > test.t[-1] - LOOP_PERIODS * period
    axis.plot(over[rows], test.force[rows], **MEASURED)
    if predicted is not None:
        axis.plot(over[rows], predicted[rows], **FOUND)
    axis.set_xlabel(label)
    axis.grid(color="#e3e7eb", linewidth=0.6)


def _over_time(axis: Any, t: Floats, values: Floats, style: dict[str, Any]) -> None:
    rows = extremes(np.asarray(values))
    axis.plot(t[rows], values[rows], **style)
    axis.grid(color="#e3e7eb", linewidth=0.6)
    axis.margins(x=0.0)
