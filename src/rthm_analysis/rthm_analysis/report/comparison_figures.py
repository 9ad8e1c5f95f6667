"""Curves of the page of a comparison: every signal in all tests, and the differences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bokeh.models import Range1d

from rthm_analysis.report.colours import COLOURS, INK
from rthm_analysis.report.figures import Curves, steps
from rthm_core.clock import NS

if TYPE_CHECKING:
    from bokeh.plotting import figure

    from rthm_analysis.comparison import Comparison, Signal
    from rthm_core.compiled import Floats


def overlays(comparison: Comparison, *, energies: bool) -> list[list[figure]]:
    """For each signal of the reference that another test has: all tests, and below it the differences.

    Energies, or all others; a signal that is zero throughout in all tests is not drawn.
    """
    end = max(one.end for one in comparison.against)
    span = Range1d(0.0, end, bounds="auto")
    names = dict.fromkeys(name for one in comparison.against for name in one.differences)
    drawn = [
        name for name in names if name.startswith("E_") is energies and _says_something(comparison, name)
    ]
    return [[plot] for name in drawn for plot in _of_signal(comparison, name, span)]


def _says_something(comparison: Comparison, name: str) -> bool:
    told = (one.motion.signals.get(name) for one in comparison.told)
    return any(one is not None and one.values.any() for one in told)


def _of_signal(comparison: Comparison, name: str, span: Range1d) -> list[figure]:
    unit = comparison.reference.signals[name].unit
    label, apart_label = f"{name} ({unit})", f"difference ({unit})"
    shown, apart = Curves(name, label, span), Curves(f"{name}: difference", apart_label, span, 200)
    reference, differs = comparison.reference, False
    shown.add(reference.name, *_curve(reference.signals[name]), INK, line_width=2.6, line_alpha=0.75)
    for told, one, colour in zip(comparison.told[1:], comparison.against, COLOURS * 9, strict=False):
        if name in one.differences:
            pair = one.differences[name].pair
            shown.add(one.name, *_curve(told.motion.signals[name]), colour)
            apart.add(one.name, pair.time, pair.other - pair.one, colour)
            differs |= bool((pair.other != pair.one).any())
    plots = [shown.finish()]
    return [*plots, apart.finish()] if differs else plots


def _curve(signal: Signal) -> tuple[Floats, Floats]:
    """Times (s) and values; a held signal as steps."""
    time = signal.at_ns / NS
    return steps(time, signal.values) if signal.held else (time, signal.values)
