"""Lines over plots of time: one that follows the mouse, and two that stay where they are put."""

from __future__ import annotations

from functools import lru_cache

from bokeh.models import CrosshairTool, Label, Range1d, Span
from bokeh.plotting import figure

from rthm_analysis.report.colours import INK, MUTED


def add_cursors(plot: figure, span: Range1d) -> None:
    """Give a plot the lines that all plots over its axis of time have; those that stay are hidden at first.

    The script of the page (``script/cursors.js``) shows them, and tells what is at both.
    """
    plot.add_tools(CrosshairTool(overlay=_follower(span)))
    for line, name in _pair(span):
        plot.add_layout(line)
        plot.add_layout(name)


@lru_cache(1)
def _follower(span: Range1d) -> Span:
    return Span(dimension="height", line_color=MUTED, line_dash="2 3", line_width=1)


@lru_cache(1)
def _pair(span: Range1d) -> tuple[tuple[Span, Label], ...]:
    return _line("t1", "solid", span), _line("t2", "7 3", span)


def _line(name: str, dash: str, span: Range1d) -> tuple[Span, Label]:
    line = Span(
        name=name, location=span.start, dimension="height", editable=True, visible=False,
        line_color=INK, line_dash=dash, line_width=1.4, level="overlay",
    )  # fmt: skip
    label = Label(
        name=name, text=name, x=span.start, y=3, y_units="screen", x_offset=3, visible=False,
        text_color=INK, text_font_size="11px", level="overlay",
    )  # fmt: skip
    return line, label
