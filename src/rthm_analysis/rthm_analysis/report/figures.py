"""The curves of a page: motion, forces, energies, distributions. They draw results and compute nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import HoverTool, Legend, Range1d
from bokeh.plotting import figure

from rthm_analysis.report.colours import AXIS, COLOURS, GRID, INK, MUTED, PAPER
from rthm_analysis.report.cursors import add_cursors
from rthm_analysis.report.gathered import Gathered
from rthm_analysis.report.thinning import SPANS, extremes
from rthm_core.compiled import Floats
from rthm_core.topics import FORCE_REFERENCE, NUMERICAL_STATE

FONT = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', sans-serif"

SAMPLES_PER_SWING = 12
"""Samples in each swing from which a line through them looks like the motion."""

ROUNDING = 1e-9
"""Size of a curve over that of the motion or energy which it is a difference of, where it is only "
"rounding."""

NO_EXCESS = 1e-9
"""Excess of an age, and spread of periods, that is none, s: stamps are whole nanoseconds."""

TERM_COLOURS = {
    "E_total": COLOURS[6],
    "E_err": INK,
    "E_fx": COLOURS[0],
    "E_ff": COLOURS[1],
    "E_num": COLOURS[4],
    "E_damping": COLOURS[2],
    "E_load": COLOURS[3],
    "E_effects": COLOURS[5],
}

TERM_WORDS = {
    "E_fx": "position cancellation",
    "E_ff": "force feedforward",
    "E_num": "numerical side",
    "E_err": "all three together",
    "E_damping": "dampers c1, c2, c3",
    "E_load": "known loads",
    "E_effects": "added effects",
    "E_total": "energy in the system",
}


class Curves:
    """A plot over the time of the test.

    Parameters
    ----------
    title, label : str
        What is drawn; quantity and unit on the vertical axis.
    span : Range1d
        Time axis, shared by all plots of a page.
    height : int
        In pixels.
    """

    def __init__(self, title: str, label: str, span: Range1d, height: int = 300) -> None:
        self.plot = plain_plot(title, "time (s)", label, height)
        self.plot.x_range = span
        add_cursors(self.plot, span)
        self._entries: list[tuple[str, list[object]]] = []
        self._hovered: list[object] = []

    def add(self, name: str, t: Floats, values: Floats, colour: str, **style: object) -> None:
        """Draw one curve, unless there is nothing to draw."""
        if not np.isfinite(values).any():
            return
        rows = extremes(values)
        line = self.plot.line(
            t[rows], values[rows], line_color=colour, name=name, **{"line_width": 1.8} | style
        )
        drawn = [line]
        if is_sparse(values):  # what is between the samples is not known
            line.glyph.line_alpha = 0.3
            drawn.append(self.plot.scatter("x", "y", source=line.data_source, size=5, color=colour))
        self._entries.append((name, drawn))
        self._hovered.append(line)

    def finish(self) -> figure:
        """Add legend and hover; the plot is then ready."""
        items = [(name, lines) for name, lines in self._entries]
        legend = Legend(
            items=items, orientation="horizontal", click_policy="hide", border_line_alpha=0.0, padding=0,
            margin=4, label_text_font=FONT, label_text_font_size="12px", label_text_color=INK, glyph_width=22,
            spacing=14, background_fill_alpha=0.0, location="top_left",
        )  # fmt: skip
        self.plot.add_layout(legend, "above")
        tips = [("", "$name"), ("time", "$x{0.0000} s"), ("value", "$y{0.000000}")]
        self.plot.add_tools(HoverTool(renderers=self._hovered, tooltips=tips, mode="mouse"))
        return self.plot


def only_rounding(difference: Floats, *of: Floats) -> bool:
    """Whether a difference of these is nothing but rounding, and its picture would be one of nothing."""
    sizes = [float(np.abs(one[np.isfinite(one)]).max(initial=0.0)) for one in (difference, *of)]
    return sizes[0] <= ROUNDING * max(sizes[1:])


def is_sparse(values: Floats) -> bool:
    """Whether a curve has so few samples in each swing that a line through them would be another curve."""
    known = values[np.isfinite(values)]
    swings = 0.5 * np.count_nonzero(np.diff(np.signbit(known - known.mean()))) if known.size else 0.0
    return bool(known.size < 2 * SPANS and swings >= 1.0 and known.size < SAMPLES_PER_SWING * swings)


def plain_plot(
    title: str, x: str, y: str, height: int, scale: str = "linear", names: Sequence[str] = ()
) -> figure:
    """Empty plot with the labels of its axes; `names`, from below, make a vertical axis of names."""
    named = {"y_range": list(names)} if names else {"y_axis_type": scale}
    plot = figure(
        title=title, height=height, sizing_mode="stretch_width", tools="pan,box_zoom",
        active_drag="box_zoom", toolbar_location=None, outline_line_color=None, min_border_left=86,
        **named,
    )  # fmt: skip
    plot.title.text_font, plot.title.text_font_size = FONT, "14px"
    plot.title.text_color, plot.title.text_font_style = INK, "bold"
    plot.grid.grid_line_color = GRID
    plot.background_fill_color = plot.border_fill_color = PAPER
    for axis, label in ((plot.xaxis, x), (plot.yaxis, y)):
        axis.axis_label, axis.axis_label_text_font_style = label, "normal"
        axis.axis_label_text_font = axis.major_label_text_font = FONT
        axis.axis_label_text_font_size, axis.major_label_text_font_size = "12px", "11px"
        axis.axis_label_text_color = axis.major_label_text_color = MUTED
        axis.axis_line_color = axis.major_tick_line_color = AXIS
        axis.minor_tick_line_color = None
    return plot


def time_axis(gathered: Gathered) -> Range1d:
    """Time axis of all curves of a page."""
    return Range1d(0.0, max(float(np.ceil(100.0 * gathered.recording.duration)) / 100.0, 0.01), bounds="auto")


def motion(gathered: Gathered, span: Range1d) -> list[figure]:
    """Positions of both substructures beside the ideal system, and how far the plant is from it."""
    recording, ideal, spec = gathered.recording, gathered.ideal, gathered.spec
    curves = Curves("Position, beside the ideal system" if ideal else "Position", "position (m)", span, 340)
    dofs = spec.plant.dofs if spec else recording.plant.names
    t = recording.seconds(recording.plant.stamp_ns)
    apart, away = Curves("Distance from the ideal system", "distance (m)", span, 220), False
    for k, dof in enumerate(dofs):
        position = recording.plant.columns("position", [dof])[:, 0]
        if ideal:
            curves.add(
                f"{dof} ideal",
                ideal.t,
                ideal.plant_position[:, k],
                COLOURS[k],
                line_dash="4 3",
                line_alpha=0.75,
            )
            at = np.interp(t, ideal.t, ideal.plant_position[:, k])
            away |= not only_rounding(position - at, at)
            apart.add(dof, t, position - at, COLOURS[k])
        curves.add(f"{dof} plant", t, position, COLOURS[k])
    numerical = recording.tables.get(NUMERICAL_STATE)
    for k, dof in enumerate(spec.numerical.dofs if spec and spec.numerical and numerical else ()):
        assert numerical is not None
        colour = COLOURS[(len(dofs) + k) % len(COLOURS)]
        when, position = recording.seconds(numerical.stamp_ns), numerical.columns("position", [dof])[:, 0]
        if ideal:
            curves.add(
                f"{dof} ideal",
                ideal.t,
                ideal.numerical_position[:, k],
                colour,
                line_dash="4 3",
                line_alpha=0.75,
            )
            at = np.interp(when, ideal.t, ideal.numerical_position[:, k])
            away |= not only_rounding(position - at, at)
            apart.add(dof, when, position - at, colour)
        curves.add(f"{dof} numerical", when, position, colour)
    return [curves.finish(), *([apart.finish()] if away else [])]


def forces(gathered: Gathered, span: Range1d) -> list[figure]:
    """Force reference beside the force in the wire."""
    recording, spec = gathered.recording, gathered.spec
    dofs = spec.plant.dofs if spec else ()
    actuators = (
        spec.actuator.names if spec and spec.actuator else [n for n in recording.plant.names if n not in dofs]
    )
    reference = recording.tables.get(FORCE_REFERENCE)
    curves = Curves("Force reference beside force" if reference else "Force", "force (N)", span)
    t, drawn = recording.seconds(recording.plant.stamp_ns), False
    for k, name in enumerate(actuators):
        force = recording.plant.columns("effort", [name])[:, 0]
        drawn |= bool(np.isfinite(force).any())
        curves.add(
            f"force in {name}" if spec and spec.actuator else f"force {name}", t, force, COLOURS[(2 * k) % 8]
        )
        if reference:
            wanted = reference.columns("effort", [name])[:, 0]
            curves.add(
                f"reference for {name}",
                *steps(recording.seconds(reference.stamp_ns), wanted),
                COLOURS[(2 * k + 1) % 8],
            )
            drawn = True
    return [curves.finish()] if drawn else []


def steps(t: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Corners of a held signal (n,), (2 n - 1,) each."""
    return np.repeat(t, 2)[1:], np.repeat(values, 2)[:-1]


def energies(gathered: Gathered, span: Range1d) -> list[figure]:
    """Energy by term, the estimate of (27) beside what it estimates, and the closure of the balance."""
    energy = gathered.energy
    if energy is None:
        return []
    by_term = Curves("Energy by term, + when introduced", "energy (J)", span, 380)
    told = energy.work | {"E_err": energy.error, "E_total": energy.total}
    for name, values in ((name, told[name]) for name in TERM_COLOURS):
        if np.any(values) or name in ("E_total", "E_err"):
            width = 2.6 if name in ("E_total", "E_err") else 1.8
            by_term.add(f"{name}: {TERM_WORDS[name]}", energy.t, values, TERM_COLOURS[name], line_width=width)
    estimate = Curves("Energy of the errors beside its first-order estimate (27)", "energy (J)", span, 240)
    estimate.add("E_err", energy.t, energy.error, TERM_COLOURS["E_err"])
    estimate.add("integral of P_err_estimate", energy.t, energy.estimated_error, COLOURS[0], line_dash="5 4")
    closure = Curves("Closure: total energy minus its start and all work", "energy (J)", span, 220)
    closure.add("balance error", energy.t, energy.balance_error, COLOURS[1])
    of_loop = bool(np.isfinite(energy.error).any()) and not only_rounding(energy.error, energy.total)
    closes = only_rounding(energy.balance_error, energy.total)
    return [
        by_term.finish(),
        *([estimate.finish()] if of_loop else []),
        *([] if closes else [closure.finish()]),
    ]


def ages(gathered: Gathered) -> list[figure]:
    """How old samples were at their use, link by link."""
    return [
        _histogram(f"Age at use, {name}", "age", link.age, COLOURS[0])
        for name, link in gathered.timing.links.items()
        if link.age.size
    ]


def excesses(gathered: Gathered) -> list[figure]:
    """By how much samples were older than the exact schedule has them; of links that kept it, none."""
    links = gathered.timing.links.items()
    return [
        _histogram(f"Excess, {name}", "excess", link.excess, COLOURS[1])
        for name, link in links
        if (np.abs(link.excess[np.isfinite(link.excess)]) > NO_EXCESS).any()
    ]


def periods(gathered: Gathered) -> list[figure]:
    """Times from tick to tick, for clocks whose ticks were not all on time."""
    clocks = gathered.timing.clocks.items()
    return [
        _histogram(f"Period of {name.capitalize()}", "period", clock.period, COLOURS[2])
        for name, clock in clocks
        if _varies(clock.period)
    ]


def _varies(period: Floats) -> bool:
    known = period[np.isfinite(period)]
    return known.size > 0 and bool(np.ptp(known) > NO_EXCESS)


def _histogram(title: str, quantity: str, seconds: Floats, colour: str, bins: int = 40) -> figure:
    """Shares on a logarithmic scale, where one use in thousands can still be seen."""
    values = 1e3 * seconds[np.isfinite(seconds)]
    plot = plain_plot(title, f"{quantity} (ms)", "share (%)", 210, "log")
    plot.min_border_left = 56
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
    room = max(0.02 * (high - low), 0.02)
    counts, edges = np.histogram(values, bins=bins, range=(low - room, high + room))
    filled = counts > 0
    share, floor = 100.0 * counts[filled] / max(values.size, 1), 50.0 / max(values.size, 1)
    left, right = edges[:-1][filled], edges[1:][filled]
    plot.quad(
        top=share,
        bottom=floor,
        left=left,
        right=right,
        fill_color=colour,
        line_color=PAPER,
        line_width=0.5,
    )
    plot.x_range = Range1d(low - room, high + room)
    plot.y_range = Range1d(floor, 200.0)
    plot.xgrid.grid_line_color = None
    plot.xaxis.ticker.desired_num_ticks = 4
    tips = [("from", "@left{0.0000} ms"), ("to", "@right{0.0000} ms"), ("share", "@top{0.000} %")]
    plot.add_tools(HoverTool(tooltips=tips))
    return plot


def rows(figures: Sequence[figure], per_row: int = 4) -> list[list[figure]]:
    """Figures side by side."""
    return [list(figures[k : k + per_row]) for k in range(0, len(figures), per_row)]
