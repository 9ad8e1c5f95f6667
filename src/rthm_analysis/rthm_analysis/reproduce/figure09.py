"""Fig. 9: all delays and periods scaled together, from none to twice Table I."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import CHOSEN, OTHERS, Candidate, loop
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import BAND, SHADES, legend_above, over_time, panels
from rthm_core.engine import Trajectory, simulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DURATION, STEP = 20.0, 0.04
SCALES = (0.0, 0.5, 1.0, 1.5, 2.0)


def _run(one: Candidate, scale: float) -> Trajectory:
    if scale == 0.0:
        return simulate(loop(one), DURATION, STEP, "ideal")
    return simulate(loop(one).scaled_timing(scale), DURATION, STEP)


def compute() -> Numbers:
    """Position of M1 and total energy for every scale."""
    positions: dict[str, np.ndarray] = {}
    energies: dict[str, np.ndarray] = {}
    spread: dict[str, np.ndarray] = {}
    values: dict[str, float] = {}
    for scale in SCALES:
        run, label = _run(CHOSEN, scale), f"T = {scale:g} T0"
        total = [run.energies["E_total"], *(_run(one, scale).energies["E_total"] for one in OTHERS)]
        share = [one / one[0] for one in total]
        positions |= {"t [s]": run.t, f"x1 [m], {label}": run.plant_position[:, 0]}
        energies |= {"t [s]": run.t, f"E_total [J], {label}": total[0]}
        spread |= {"t [s]": run.t, f"least share, {label}": np.min(share, axis=0)}
        spread[f"largest share, {label}"] = np.max(share, axis=0)
        values[f"share of energy left at 10 s, {label}"] = float(share[0][round(10.0 / STEP)])
        values[f"least over all sets, {label}"] = float(spread[f"least share, {label}"][round(10.0 / STEP)])
        values[f"largest over all sets, {label}"] = float(
            spread[f"largest share, {label}"][round(10.0 / STEP)]
        )
    return Numbers({"position": positions, "energy": energies, "spread": spread}, values)


def found(numbers: Numbers) -> str:
    """What is left after 10 s."""
    left = [numbers.values[f"share of energy left at 10 s, T = {scale:g} T0"] for scale in SCALES]
    words = ", ".join(
        f"{100 * share:.2g} % for {scale:g} T0" for scale, share in zip(SCALES, left, strict=True)
    )
    return (
        f"After 10 s the system has left, of its energy: {words}. More delay always drains more, for every "
        "set."
    )


def draw(numbers: Numbers) -> Figure:
    """Positions above, energy below on a logarithmic scale, spread as bands."""
    positions, energies, spread = (numbers.tables[name] for name in ("position", "energy", "spread"))
    t = positions["t [s]"]
    figure, axes = panels(2, height=3.6, sharex=True)
    top, low = axes[:, 0]
    for scale, colour in zip(SCALES, SHADES, strict=True):
        label = f"T = {scale:g} T0"
        look = {"color": colour, "linewidth": 1.0, "linestyle": (0, (4, 2)) if scale == 0.0 else "-"}
        top.plot(t, positions[f"x1 [m], {label}"], **look, label=rf"$T={scale:g}\,T_0$")
        total = energies[f"E_total [J], {label}"]
        low.plot(t, total, **look)
        first = total[0]
        low.fill_between(
            t,
            spread[f"least share, {label}"] * first,
            spread[f"largest share, {label}"] * first,
            color=colour,
            **BAND,
        )
    top.set(ylabel=r"position of $M_1$  (m)")
    legend_above(top, 3)
    low.set(ylabel=r"$E_{total}$  (J)", yscale="log", ylim=(1e-3, 3.0))
    over_time(low, DURATION)
    return figure


FIGURE = Plate(
    "figure09",
    "Fig. 9: delays from none to twice those of Table I",
    "The longer the delays, the less accurate the hybrid system; the terms that extract energy dominate.",
    True,
    compute,
    found,
    draw,
)
