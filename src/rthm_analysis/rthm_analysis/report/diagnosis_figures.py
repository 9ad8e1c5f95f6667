"""The curves of the page of a diagnosis."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from bokeh.models import ColumnDataSource, Range1d, Whisker
from bokeh.plotting import figure

from rthm_analysis.diagnosis.result import Curve, Fit
from rthm_analysis.report.figures import COLOURS, INK, MUTED, Curves

MODELS = {"nominal": COLOURS[4], "retuned": COLOURS[0], "explained": COLOURS[2]}
MODEL_WORDS = {"nominal": "as specified", "retuned": "retuned", "explained": "explained"}


def fit_plots(fit: Fit) -> Iterator[figure]:
    """Recorded signal beside its simulations, and what each leaves."""
    if fit.time is None or fit.recorded is None:
        return
    span = Range1d(float(fit.time[0]), float(fit.time[-1]))
    shown = Curves(f"{fit.signal} ({fit.block})", fit.signal, span)
    left = Curves(f"{fit.signal}: recorded minus simulated", fit.signal, span)
    shown.add("recorded", fit.time, fit.recorded, INK)
    for name, colour in MODELS.items():
        simulated = getattr(fit, name)
        if simulated is not None:
            words = f"{MODEL_WORDS[name]} ({100.0 * fit.nrmse.get(name, float('nan')):.3g} %)"
            shown.add(words, fit.time, simulated, colour, line_dash="dashed")
            left.add(words, fit.time, fit.recorded - simulated, colour)
    yield shown.finish()
    yield left.finish()


def curve_plot(curve: Curve) -> figure:
    """Force over the variable that explains it."""
    plot = figure(
        title=f"{curve.block}: residual force over {curve.variable}",
        x_axis_label=f"{curve.variable} ({curve.unit})",
        y_axis_label="force (N)",
        height=320,
        sizing_mode="stretch_width",
        toolbar_location="above",
    )
    source = ColumnDataSource(
        {"at": curve.at, "low": curve.force - curve.std, "high": curve.force + curve.std}
    )
    plot.add_layout(Whisker(source=source, base="at", lower="low", upper="high", line_color=MUTED))
    plot.scatter(curve.at, curve.force, size=7, color=COLOURS[1])
    if curve.named is not None and np.isfinite(curve.named).any():
        plot.line(curve.at, curve.named, line_color=COLOURS[2], line_width=2, legend_label="named")
    return plot
