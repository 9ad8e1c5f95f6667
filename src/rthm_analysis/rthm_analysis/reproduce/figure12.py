"""Fig. 12: harmonic loads of 1 N on M1, from rest, at 1 and at 2.4 rad/s."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import CHOSEN, OTHERS, Candidate, loop
from rthm_analysis.reproduce.frequency import MARKED
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import HYBRID, IDEAL, OTHER_SET, over_time, panels
from rthm_core.engine import Trajectory, simulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DURATION, STEP = 60.0, 0.05


def excited(one: Candidate, omega: float, system: str, duration: float = DURATION) -> Trajectory:
    """The loop from rest under a load of 1 N on M1."""
    load = {"dof": "x1", "kind": "harmonic", "amplitude": 1.0, "frequency": omega, "phase": 0.0}
    spec = loop(one, **{"plant.initial_position": 0.0, "load.plant": load})
    return simulate(spec, duration, STEP, system, energies=False)


def amplitude(run: Trajectory, omega: float, last: float) -> tuple[float, float]:
    """Amplitude (m) and phase (deg) of x1 at `omega` over whole periods within the last part of a run."""
    period = 2.0 * np.pi / omega
    kept = run.t > run.t[-1] - period * int(last / period)
    t, x = run.t[kept], run.plant_position[kept, 0]
    basis = np.column_stack([np.sin(omega * t), np.cos(omega * t), np.ones_like(t)])
    sine, cosine, _ = np.linalg.lstsq(basis, x, rcond=None)[0]
    return float(np.hypot(sine, cosine)), float(np.degrees(np.arctan2(cosine, sine)))


def compute() -> Numbers:
    """Position of M1, hybrid and ideal."""
    tables: dict[str, dict[str, np.ndarray]] = {}
    values: dict[str, float] = {}
    for omega in MARKED:
        hybrid, ideal = excited(CHOSEN, omega, "hybrid"), excited(CHOSEN, omega, "ideal")
        columns = {
            "t [s]": hybrid.t,
            "x1 hybrid [m]": hybrid.plant_position[:, 0],
            "x1 ideal [m]": ideal.plant_position[:, 0],
        }
        for one in OTHERS:
            columns[f"x1 hybrid [m], {one.label}"] = excited(one, omega, "hybrid").plant_position[:, 0]
        tables[f"{omega:g} rad per s"] = columns
        values[f"amplitude hybrid at {omega:g} rad/s, last 25 s [m]"] = amplitude(hybrid, omega, 25.0)[0]
        values[f"amplitude ideal at {omega:g} rad/s, last 25 s [m]"] = amplitude(ideal, omega, 25.0)[0]
    return Numbers(tables, values)


def found(numbers: Numbers) -> str:
    """Amplitudes of the last 25 s."""
    v = numbers.values
    slow, slow_ideal, fast, fast_ideal = (
        v[f"amplitude {system} at {omega:g} rad/s, last 25 s [m]"]
        for omega in MARKED
        for system in ("hybrid", "ideal")
    )
    return (
        f"At 1 rad/s both systems end at nearly one amplitude ({slow * 1e3:.0f} and {slow_ideal * 1e3:.0f} "
        f"mm in the last 25 s); at 2.4 rad/s the hybrid system stays at {fast * 1e3:.0f} mm while the ideal "
        f"one has grown to {fast_ideal * 1e3:.0f} mm."
    )


def draw(numbers: Numbers) -> Figure:
    """One panel per frequency."""
    figure, axes = panels(2, height=3.3, sharex=True)
    for omega, one in zip(MARKED, axes[:, 0], strict=True):
        columns = numbers.tables[f"{omega:g} rad per s"]
        t = columns["t [s]"]
        for name, values in columns.items():
            if "M2" in name:
                one.plot(t, values, **OTHER_SET)
        one.plot(t, columns["x1 hybrid [m]"], **HYBRID, label="hybrid")
        one.plot(t, columns["x1 ideal [m]"], **IDEAL, label="ideal")
        one.plot([], [], **OTHER_SET, label="hybrid, other sets")
        one.set(ylabel=r"$x_1$  (m)", title=rf"$\omega={omega:g}$ rad/s")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    over_time(axes[1, 0], DURATION)
    return figure


FIGURE = Plate(
    "figure12",
    "Fig. 12: harmonic loads",
    "The steady state of the simulations corresponds well to the Bode plot; near resonance the hybrid system "
    "stays far below the ideal one.",
    True,
    compute,
    found,
    draw,
)
