"""Plots inside a page: their places, what they show in words, and what the script makes them of."""

from __future__ import annotations

import json
from collections.abc import Sequence
from html import escape
from importlib.resources import files
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.report.colours import palette

if TYPE_CHECKING:
    from bokeh.plotting import figure

COLUMNS = {1: "", 2: "two", 3: "three", 4: "four"}


SCRIPT = ("plots", "colours", "fitting", "drawing", "files", "controls", "cursors", "paper")
"""Parts of the script of a page, in their order."""


class Embedding:
    """The plots of one page, in the order in which they are placed."""

    def __init__(self) -> None:
        self._plots: list[figure] = []

    def row(self, plots: Sequence[figure]) -> str:
        """Places of plots beside each other."""
        inside = "".join(self._place(plot) for plot in plots)
        return f'<div class="row {COLUMNS[len(plots)]}">{inside}</div>'

    def _place(self, plot: figure) -> str:
        self._plots.append(plot)
        words = escape(in_words(plot), quote=True)
        return (
            f'<figure class="plot"><div class="live" id="plot-{len(self._plots)}" role="img" '
            f'aria-label="{words}"></div></figure>'
        )

    def scripts(self) -> str:
        """Everything that the plots need, the library included; nothing where there are none."""
        if not self._plots:
            return ""
        from bokeh.document import Document
        from bokeh.resources import Resources

        document = Document()
        for plot in self._plots:
            document.add_root(plot)
        roots = {plot.id: f"plot-{k}" for plot, k in zip(self._plots, count(1))}
        item = {"docid": "plots", "roots": roots, "root_ids": list(roots)}
        library = Resources(mode="inline", components=["bokeh"]).render_js()
        own = "\n".join((files(__package__) / "script" / f"{name}.js").read_text("utf-8") for name in SCRIPT)
        plots = {"docs": {"plots": document.to_json(deferred=False)}, "items": [item]}
        colours = {light: name for name, light in palette().items()}
        data = _data("plots", plots) + _data("palette", colours)
        return f"{library}{data}<script>(async () => {{\n{own}}})();</script>"


def in_words(plot: figure) -> str:
    """What a plot shows, for those who do not see it: its curves and between what values they are."""
    label = plot.yaxis[0].axis_label or plot.xaxis[0].axis_label
    told = [words for one in plot.renderers if (words := _range(one))]
    over = f" Over {plot.xaxis[0].axis_label}, {label}." if label else ""
    return f"{plot.title.text}.{over} {'; '.join(told)}".strip()


def _range(renderer: Any) -> str:
    """Name of a curve with its least and largest value; empty for what has no name."""
    values = np.asarray(renderer.data_source.data.get("y", ()), dtype=float)
    known = values[np.isfinite(values)]
    if not renderer.name or not known.size:
        return ""
    return f"{renderer.name}: {known.min():.3g} to {known.max():.3g}"


def script_safe(text: str) -> str:
    """JSON that cannot end the element it stands in."""
    return text.replace("<", "\\u003c")


def _data(name: str, value: Any) -> str:
    return f'<script type="application/json" id="{name}">{script_safe(json.dumps(value))}</script>'
