"""Figures of the runs beside what is asked of them."""

from __future__ import annotations

from typing import Any, NamedTuple

EXCESS = {True: 0.3e-3, False: 0.6e-3}
"""Largest excess at p99 of every link, s, with real-time priority and without."""

ENERGY = 0.03
"""Largest difference of an energy from the exact engine's, relative."""

SPEED = 2.0
"""Least speed of simulated time, relative to real time."""

POSITION = 1e-9
"""Largest difference of a position in simulated time from the exact engine's, m."""


class Line(NamedTuple):
    """One figure: what it is, its value and what is asked of it in words, and whether it is met."""

    what: str
    value: str
    asked: str
    met: bool


def judge_real_time(figures: dict[str, Any]) -> list[Line]:
    """Lines about a run in real time (`measure.in_real_time`)."""
    granted = figures["priority"]
    limit = EXCESS[granted]
    lines = [Line("samples lost", str(figures["lost"]), "0", figures["lost"] == 0)]
    for name, excess in figures["excess"].items():
        asked = f"<= {1e3 * limit:g} ms {'with' if granted else 'without'} real-time priority"
        apart = figures["excess_undisturbed"][name]["p99"]
        value = f"{1e3 * excess['p99']:.3f} ms"
        if apart is not None:
            value += f" ({1e3 * apart:.3f} ms where the machine held nothing up)"
        lines.append(Line(f"excess of {name}, p99", value, asked, excess["p99"] <= limit))
    for term, energy in figures["energies"].items():
        off = abs(energy["run"] / energy["exact"] - 1.0)
        value = f"{energy['run']:.4f} J, exact {energy['exact']:.4f} J"
        lines.append(Line(term, value, f"within {100 * ENERGY:g} %", off <= ENERGY))
    return lines


def judge_simulated_time(figures: dict[str, Any]) -> list[Line]:
    """Lines about two runs in simulated time (`measure.in_simulated_time`)."""
    speed, difference = min(figures["speed"]), figures["difference"]
    same = "the same bytes" if figures["identical"] else "other bytes"
    return [
        Line("speed", f"{speed:.2f} x real time", f">= {SPEED:g} x", speed >= SPEED),
        Line(
            "positions beside the engine's",
            f"{difference:.1e} m",
            f"<= {POSITION:g} m",
            difference <= POSITION,
        ),
        Line(f"{figures['messages']} messages, repeated", same, "the same bytes", figures["identical"]),
    ]
