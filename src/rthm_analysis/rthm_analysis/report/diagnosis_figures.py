"""The curves of the page of a diagnosis. They draw results and compute nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from bokeh.models import (
    BasicTickFormatter,
    BoxAnnotation,
    ColumnDataSource,
    HoverTool,
    Range1d,
    Span,
    Whisker,
)
from bokeh.plotting import figure

from rthm_analysis.diagnosis.missing.describe import VARIABLE_UNITS
from rthm_analysis.diagnosis.numbers import percent
from rthm_analysis.diagnosis.result import Curve, Described, Fit
from rthm_analysis.report.colours import AXIS, COLOURS, INK, MUTED
from rthm_analysis.report.diagnosis_tables import MODEL_WORDS
from rthm_analysis.report.figures import FONT, Curves, plain_plot

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

MODELS = {"nominal": COLOURS[4], "retuned": COLOURS[0], "explained": COLOURS[2]}
VARIABLES = {
    "x": "the position",
    "v": "the velocity",
    "t": "time",
    "u": "the motor's position",
    "load": "the known load",
    "u - x": "the elongation",
    "du/dt - v": "the rate of elongation",
}
"""Abscissae of a curve, in words."""

POWERS_FROM = -6
"""Power of ten from which an axis is labelled with powers."""

SHOWN_SWINGS = 12
"""Swings of a signal that a plot shows at first."""

INNER = slice(1, -1)
"""Points of a curve that its plot shows for certain; the outermost average over rare, far values."""


def fit_plots(fit: Fit) -> Iterator[figure]:
    """Recorded signal beside its simulations, and what each leaves."""
    if fit.time is None or fit.recorded is None or not fit.time.size:
        return
    label = _quantity(fit)
    span = Range1d(*_first_view(fit.time, fit.recorded))
    shown = Curves(f"{fit.signal} ({fit.block}), recorded and simulated", label, span)
    left = Curves(f"{fit.signal}: what each simulation leaves", label, span)
    nominal: Any = fit.nominal
    for name, colour in MODELS.items():
        simulated = getattr(fit, name)
        if simulated is None or (name != "nominal" and np.array_equal(simulated, nominal)):
            continue
        words = f"{MODEL_WORDS[name]} ({percent(fit.nrmse.get(name, math.nan), 3)})"
        shown.add(words, fit.time, simulated, colour, line_width=2.4)
        left.add(words, fit.time, fit.recorded - simulated, colour)
    shown.add("recorded", fit.time, fit.recorded, INK, line_width=1.0)
    for plot in (shown.plot, left.plot):
        plot.yaxis.formatter = BasicTickFormatter(power_limit_low=POWERS_FROM)
    yield shown.finish()
    yield left.finish()


def _quantity(fit: Fit) -> str:
    """Quantity and unit of the output of a block."""
    if fit.block in ("wire", "sensor.force", "numerical"):
        return "force (N)"
    if fit.signal == "age":
        return "age (s)"
    if fit.signal.startswith("acc"):
        return "acceleration (m/s^2)"
    return "velocity (m/s)" if fit.signal.startswith("v") else "position (m)"


def _first_view(time: Floats, signal: Floats) -> tuple[float, float]:
    """Span of a few swings, so that curves can be told apart; zooming out shows the rest."""
    known = np.nan_to_num(signal - np.nanmean(signal))
    crossings = np.flatnonzero(np.diff(np.signbit(known)))
    last = crossings[2 * SHOWN_SWINGS] if crossings.size > 2 * SHOWN_SWINGS else time.size - 1
    return float(time[0]), float(time[last])


def curve_plot(curve: Curve, law: str = "named physics", unit: str = "N") -> figure:
    """Force over the variable that explains it, with the force of what was named, or of another `law`; of a
    motor its error, in its own `unit`.
    """
    what, label = ("the missing force", "force") if unit == "N" else ("the error of the position", "error")
    title = f"{curve.block}: {what} over {VARIABLES.get(curve.variable, curve.variable)}"
    plot = plain_plot(title, f"{curve.variable} ({curve.unit})", f"{label} ({unit})", 340)
    spread = {"at": curve.at, "force": curve.force, "std": curve.std}
    source = ColumnDataSource(spread | {"low": curve.force - curve.std, "high": curve.force + curve.std})
    plot.add_layout(Span(location=0.0, dimension="width", line_color=AXIS, line_width=1))
    plot.add_layout(Whisker(source=source, base="at", lower="low", upper="high", line_color=MUTED))
    dots = plot.scatter(
        "at", "force", source=source, size=7, color=COLOURS[1], name="recording", legend_label="recording"
    )
    if curve.law is not None and np.isfinite(curve.law[1]).any():
        plot.scatter(*curve.law, size=3, color=COLOURS[2], name=law, legend_label=law)
    tips = [(curve.variable, "@at{0.000000}"), (label, f"@force{{0.000000}} +- @std{{0.000000}} {unit}")]
    plot.add_tools(HoverTool(renderers=[dots], tooltips=tips))
    plot.x_range, plot.y_range = _around(curve.at[INNER]), _around(_drawn(curve))
    for axis in (plot.xaxis, plot.yaxis):
        axis.formatter = BasicTickFormatter(power_limit_low=POWERS_FROM)
    plot.legend.label_text_font, plot.legend.border_line_alpha = FONT, 0.0
    plot.legend.orientation, plot.legend.background_fill_alpha = "horizontal", 0.0
    plot.legend.label_text_color, plot.legend.label_text_font_size, plot.legend.location = (
        INK,
        "12px",
        "top_left",
    )
    plot.add_layout(plot.legend[0], "above")
    return plot


def described_plot(one: Described) -> figure:
    """A force without a name over the first of its variables, with its formula."""
    variable = (one.depends_on or ("x",))[0]
    unit = VARIABLE_UNITS[variable]
    curve = Curve(one.block, variable, unit, one.at, one.force, one.std, one.law, one.held_out_gain)
    return curve_plot(curve, "fitted law", one.unit)


def _drawn(curve: Curve) -> Floats:
    """Forces at the points that are shown for certain."""
    rows = [curve.force[INNER] - curve.std[INNER], curve.force[INNER] + curve.std[INNER]]
    return np.concatenate([*rows, [0.0], *([] if curve.law is None else [_inside(curve)])])


def _inside(curve: Curve) -> Floats:
    """Forces of the named physics between the points that are shown for certain."""
    assert curve.law is not None
    low, high = np.min(curve.at[INNER]), np.max(curve.at[INNER])
    return curve.law[1][(curve.law[0] >= low) & (curve.law[0] <= high)]


def _around(values: Floats) -> Range1d:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = 0.06 * (high - low) or 1.0
    return Range1d(low - room, high + room)


def energy_plot(found: Mapping[str, float], delays: Mapping[str, float]) -> figure:
    """Bars of work, J, by name: of what was found, and beneath them those of the delays."""
    labels = {f"{name}: {work:+.3g} J": work for name, work in (*found.items(), *delays.items())}
    names = list(reversed(labels))
    title, height = "Work on the moving masses, + when introduced", 70 + 34 * len(names)
    plot = plain_plot(title, "work (J)", "", height, names=names)
    values = [labels[name] for name in names]
    for rows, colour in ((slice(len(delays)), MUTED), (slice(len(delays), None), COLOURS[1])):
        source = ColumnDataSource({"name": names[rows], "work": values[rows]})
        plot.hbar(y="name", right="work", height=0.6, fill_color=colour, line_color=None, source=source)
    plot.add_layout(Span(location=0.0, dimension="height", line_color=INK, line_width=1))
    if found and delays:
        plot.add_layout(
            BoxAnnotation(bottom=len(delays), fill_color=COLOURS[1], fill_alpha=0.05, line_color=None)
        )
    plot.ygrid.grid_line_color = None
    plot.yaxis.major_label_text_color = INK
    plot.add_tools(HoverTool(tooltips=[("", "@name")]))
    return plot
