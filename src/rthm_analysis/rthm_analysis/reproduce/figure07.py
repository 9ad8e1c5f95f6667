"""Fig. 7: hybrid system, its linear approximation, the ideal system, and the error of the approximation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import ALL, CHOSEN, OTHERS, loop
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import HYBRID, IDEAL, OTHER_SET, TAYLOR, legend_above, over_time, panels
from rthm_core.engine import simulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DURATION, STEP = 20.0, 0.02


def compute() -> Numbers:
    """Step of 0.5 m at M1, 20 s, three systems."""
    columns: dict[str, np.ndarray] = {}
    for system, name in (("hybrid", "x1 hybrid [m]"), ("taylor", "x1 linear [m]"), ("ideal", "x1 ideal [m]")):
        run = simulate(loop(), DURATION, STEP, system, energies=False)
        columns |= {"t [s]": run.t, name: run.plant_position[:, 0]}
    columns["error [m]"] = columns["x1 hybrid [m]"] - columns["x1 linear [m]"]
    others, worst = {"t [s]": columns["t [s]"]}, {CHOSEN: np.abs(columns["error [m]"]).max()}
    for one in OTHERS:
        hybrid, linear = (
            simulate(loop(one), DURATION, STEP, system, energies=False).plant_position[:, 0]
            for system in ("hybrid", "taylor")
        )
        others |= {f"x1 hybrid [m], {one.label}": hybrid, f"error [m], {one.label}": hybrid - linear}
        worst[one] = np.abs(hybrid - linear).max()
    return Numbers(
        {"position": columns, "other sets": others},
        {
            "largest error of the approximation [m]": worst[CHOSEN],
            "least over all sets [m]": min(worst[one] for one in ALL),
            "largest over all sets [m]": max(worst[one] for one in ALL),
            "largest difference hybrid - ideal [m]": np.abs(
                columns["x1 hybrid [m]"] - columns["x1 ideal [m]"]
            ).max(),
        },
    )


def found(numbers: Numbers) -> str:
    """How good the approximation is beside what it describes."""
    v = numbers.values
    return (
        f"The approximation is off by at most {v['largest error of the approximation [m]'] * 1e3:.1f} mm "
        f"({v['least over all sets [m]'] * 1e3:.1f} to {v['largest over all sets [m]'] * 1e3:.1f} mm over "
        "the five sets), while hybrid and ideal system differ by up to "
        f"{v['largest difference hybrid - ideal [m]'] * 1e3:.0f} mm."
    )


def draw(numbers: Numbers) -> Figure:
    """Positions above, error below; other sets thin and grey."""
    columns, others = numbers.tables["position"], numbers.tables["other sets"]
    t = columns["t [s]"]
    figure, axes = panels(2, height=3.1, sharex=True, height_ratios=[1.7, 1.0])
    top, low = axes[:, 0]
    for name, values in others.items():
        if name != "t [s]":
            (top if name.startswith("x1") else low).plot(
                t, values * (1.0 if "x1" in name else 1e3), **OTHER_SET
            )
    top.plot(t, columns["x1 ideal [m]"], **IDEAL, label=r"ideal $x_1'$")
    top.plot(t, columns["x1 hybrid [m]"], **HYBRID, label=r"hybrid $x_1$")
    top.plot(t, columns["x1 linear [m]"], **TAYLOR, label=r"linear $\hat{x}_1$")
    top.plot([], [], **OTHER_SET, label="hybrid, other sets")
    legend_above(top, 2)
    low.plot(t, columns["error [m]"] * 1e3, **HYBRID)
    top.set(ylabel=r"position of $M_1$  (m)", ylim=(-0.55, 0.55))
    low.set(ylabel=r"$x_1-\hat{x}_1$  (mm)")
    over_time(low, DURATION)
    return figure


FIGURE = Plate(
    "figure07",
    "Fig. 7: hybrid system, linear approximation, ideal system",
    "The first-order approximation is quite good for the delays of Table I.",
    True,
    compute,
    found,
    draw,
)
