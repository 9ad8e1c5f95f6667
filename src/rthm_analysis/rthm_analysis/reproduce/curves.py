"""Curves of a figure to zoom into: one plot for each quantity of its main tables."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.numbers import Numbers
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from bokeh.plotting import figure

UNIT = re.compile(r"^(?P<name>.*?) \[(?P<unit>[^\]]+)\](?P<rest>.*)$")
QUANTITIES = {"m": "position (m)", "J": "energy (J)", "1": "signal (1)", "s": "age (s)", "deg": "phase (deg)"}
QUANTITIES |= {"m/N": "magnitude (m/N)", "dB": "magnitude (dB)"}

FEWEST_ROWS = 20
"""Rows from which a table is a curve."""


def curves(numbers: Numbers) -> list[figure]:
    """Plots of the tables of a figure; what other candidate sets give is in its files alone."""
    tables = [one for name, one in numbers.tables.items() if name not in ("other_sets", "spread")]
    return [plot for table in tables for plot in _of_table(table)]


def _of_table(table: Mapping[str, Floats]) -> list[figure]:
    from bokeh.models import Range1d

    from rthm_analysis.report.colours import COLOURS
    from rthm_analysis.report.figures import Curves

    over, *names = table
    x = np.asarray(table[over])
    if x.size < FEWEST_ROWS:
        return []
    span = Range1d(float(x.min()), float(x.max()), bounds="auto")
    quantities: dict[str, Curves] = {}
    counts: dict[str, int] = {}
    for name in names:
        found = UNIT.match(name)
        if found is None or "M2" in name:
            continue
        label = QUANTITIES.get(found["unit"], found["unit"])
        if label not in quantities:
            quantities[label] = Curves(label.partition(" (")[0].capitalize(), label, span)
            quantities[label].plot.xaxis.axis_label = over.replace("[", "(").replace("]", ")")
        colour = COLOURS[counts.setdefault(label, 0) % len(COLOURS)]
        counts[label] += 1
        quantities[label].add(f"{found['name']}{found['rest']}", x, np.asarray(table[name]), colour)
    return [one.finish() for one in quantities.values()]
