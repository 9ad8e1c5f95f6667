"""Fig. 10: one millisecond of tau1 alone, without any damping, for two stiffnesses of the actuator."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import CHOSEN, OTHERS, Candidate, loop
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import IDEAL, OTHER_SET, legend_above, over_time, panels
from rthm_core.energy import bodies, total_energy_of
from rthm_core.engine import Trajectory, simulate
from rthm_core.spec import Spec

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DURATION, STEP = 20.0, 0.02
DELAY, PERIOD = 1e-3, 1e-4
"""Delay of the position cancellation, and the short period that stands for none, in s; half of the period is
part of the delay.
"""

STIFFNESSES = (40.0, 140.0)
COLOURS = ("#0072b2", "#d55e00")


def undamped(one: Candidate, k_tot: float) -> Spec:
    """Loop without damping whose only delay is one millisecond on the way of x1 to the motor."""
    still = {f"timing.{name}": 0.0 for name in ("td4", "tau2", "tau3", "tau4")}
    fast = {f"timing.{name}": PERIOD for name in ("td1", "td2", "td3")}
    no_damping = dict.fromkeys(("plant.damping", "numerical.damping", "interface.damping"), 0.0)
    delay = {"timing.tau1": DELAY - 0.5 * PERIOD, "actuator.stiffness": k_tot}
    return loop(one, **still, **fast, **no_damping, **delay)


def _energy(spec: Spec, run: Trajectory) -> np.ndarray:
    state = (run.plant_position, run.plant_velocity, run.numerical_position, run.numerical_velocity)
    balance = bodies(spec)
    return np.array([total_energy_of(balance, *row) for row in zip(*state, strict=True)])


def compute() -> Numbers:
    """Position of M1 and total energy."""
    spec = undamped(CHOSEN, STIFFNESSES[0])
    ideal = simulate(spec, DURATION, STEP, "ideal", energies=False)
    columns = {
        "t [s]": ideal.t,
        "x1 ideal [m]": ideal.plant_position[:, 0],
        "E ideal [J]": _energy(spec, ideal),
    }
    others, values = {"t [s]": ideal.t}, {}
    for k_tot in STIFFNESSES:
        left = {}
        for one in (CHOSEN, *OTHERS):
            spec = undamped(one, k_tot)
            run = simulate(spec, DURATION, STEP, energies=False)
            energy = _energy(spec, run)
            left[one] = float(energy[-1] / energy[0])
            if one is CHOSEN:
                columns |= {
                    f"x1 [m], k_tot {k_tot:g}": run.plant_position[:, 0],
                    f"E [J], k_tot {k_tot:g}": energy,
                }
            else:
                others[f"E [J], k_tot {k_tot:g}, {one.label}"] = (
                    energy / energy[0] * columns["E ideal [J]"][0]
                )
        values[f"share of energy left, k_tot {k_tot:g}"] = left[CHOSEN]
        values[f"least over all sets, k_tot {k_tot:g}"] = min(left.values())
        values[f"largest over all sets, k_tot {k_tot:g}"] = max(left.values())
        values[f"damping k_tot tau1 [N s/m], k_tot {k_tot:g}"] = k_tot * DELAY
    return Numbers({"step": columns, "other sets": others}, values)


def found(numbers: Numbers) -> str:
    """How much one millisecond drains."""
    v = numbers.values
    soft, stiff = (v[f"share of energy left, k_tot {k:g}"] for k in STIFFNESSES)
    return (
        f"One millisecond is a damper of 0.04 Ns/m at 40 N/m and of 0.14 Ns/m at 140 N/m: after 20 s, "
        f"{100 * soft:.0f} % and {100 * stiff:.0f} % of the energy are left of a system that would lose none."
    )


def draw(numbers: Numbers) -> Figure:
    """Positions above, energy below."""
    columns, others = numbers.tables["step"], numbers.tables["other sets"]
    t = columns["t [s]"]
    figure, axes = panels(2, height=3.4, sharex=True, height_ratios=[1.4, 1.0])
    top, low = axes[:, 0]
    top.plot(t, columns["x1 ideal [m]"], **IDEAL, label="ideal")
    low.plot(t, columns["E ideal [J]"], **IDEAL)
    for name, values in others.items():
        if name != "t [s]":
            low.plot(t, values, **OTHER_SET)
    for k_tot, colour in zip(STIFFNESSES, COLOURS, strict=True):
        label = rf"$k_{{tot}}={k_tot:g}$ N/m"
        top.plot(t, columns[f"x1 [m], k_tot {k_tot:g}"], color=colour, linewidth=1.1, label=label)
        low.plot(t, columns[f"E [J], k_tot {k_tot:g}"], color=colour, linewidth=1.3)
    low.plot([], [], **OTHER_SET, label="other sets, scaled to the same start")
    low.legend(loc="lower left")
    top.set(ylabel=r"position of $M_1$  (m)")
    legend_above(top, 3)
    low.set(ylabel=r"$E_{total}$  (J)", ylim=(0.0, None))
    over_time(low, DURATION)
    return figure


FIGURE = Plate(
    "figure10",
    "Fig. 10: one millisecond of delay in the position cancellation",
    "Without any damping, one millisecond of tau1 already has a considerable damping effect, more so the "
    "stiffer the actuator.",
    True,
    compute,
    found,
    draw,
)
