"""The figure that the paper did not draw: decay and energy with and without forward prediction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.reproduce.candidates import CHOSEN, OTHERS, Candidate, loop
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import (
    HYBRID,
    IDEAL,
    POLYNOMIAL,
    TAYLOR,
    TERM_COLOURS,
    TERM_NAMES,
    legend_above,
    over_time,
    panels,
)
from rthm_core.engine import simulate
from rthm_core.spec import Spec

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DURATION, STEP = 20.0, 0.02
WAYS = (("none", HYBRID), ("taylor", TAYLOR), ("polynomial", POLYNOMIAL))
TERMS = ("E_fx", "E_ff", "E_num", "E_err")
MISJUDGED = (-0.005, -0.0025, 0.0, 0.0025, 0.005)
"""By how much the compensator may be wrong about the delay of the motor, s."""

NOISE: dict[str, Any] = {
    "noise.position": 1e-4,
    "noise.velocity": 2e-3,
    "noise.motor": 1e-5,
    "noise.force": 0.02,
}


def compensated(way: str, one: Candidate = CHOSEN, **changes: object) -> Spec:
    """The paper's loop with a compensator."""
    return loop(one, **{"actuator.compensator": way} | changes)


def _force_noise(way: str) -> float:
    """Standard deviation of the wire's force that comes from noise of the sensors, N."""
    noisy, quiet = (
        simulate(compensated(way, **noise), 10.0, 0.004, energies=False).actuator_force
        for noise in (NOISE, {})
    )
    return float((noisy - quiet).std())


def compute() -> Numbers:
    """Step of 0.5 m with every compensator: position, energy, what a misjudged delay leaves, noise."""
    ideal = simulate(loop(), DURATION, STEP, "ideal", energies=False)
    columns = {"t [s]": ideal.t, "x1 ideal [m]": ideal.plant_position[:, 0]}
    energies: dict[str, np.ndarray] = {"t [s]": ideal.t}
    misjudged = {"error of the believed delay [s]": np.array(MISJUDGED)}
    values: dict[str, float] = {}
    for way, _ in WAYS:
        run = simulate(compensated(way), DURATION, STEP)
        columns[f"x1 {way} [m]"] = run.plant_position[:, 0]
        work = run.all_energies()
        energies |= {f"{term} {way} [J]": of_term for term, of_term in work.items()}
        values |= _spread(way, work)
        difference = np.abs(run.plant_position - ideal.plant_position).max()
        values[f"largest difference from the ideal system, {way} [m]"] = float(difference)
        values[f"force noise, {way} [N]"] = _force_noise(way)
        if way != "none":
            misjudged[f"E_fx {way} [J]"] = np.array([_misjudged(way, by) for by in MISJUDGED])
    return Numbers({"position": columns, "energy": energies, "misjudged delay": misjudged}, values)


def _spread(way: str, chosen: dict[str, np.ndarray]) -> dict[str, float]:
    """Work after the test, and their least and largest over all sets, J."""
    others = [simulate(compensated(way, one), DURATION, DURATION).all_energies() for one in OTHERS]
    values = {}
    for term in TERMS:
        ends = [float(one[term][-1]) for one in (chosen, *others)]
        values[f"{term} {way}, at 20 s [J]"] = ends[0]
        values[f"{term} {way}, least over all sets [J]"] = min(ends)
        values[f"{term} {way}, largest over all sets [J]"] = max(ends)
    return values


def _misjudged(way: str, by: float) -> float:
    horizon: dict[str, Any] = {"actuator.compensator_horizon": loop().loop().timing.tau4 + by}
    spec = compensated(way, **horizon)
    return float(simulate(spec, DURATION, DURATION).energies["E_fx"][-1])


def found(numbers: Numbers) -> str:
    """What is left, and at which price."""
    v = numbers.values
    without, taylor, polynomial = (v[f"E_fx {way}, at 20 s [J]"] for way, _ in WAYS)
    noise = [v[f"force noise, {way} [N]"] for way, _ in WAYS]
    left = numbers.tables["misjudged delay"]["E_fx polynomial [J]"]
    return (
        f"Position cancellation drains {-without:.2f} J without prediction; {abs(taylor) * 1e3:.0f} mJ are "
        f"left with the linear terms and {abs(polynomial) * 1e3:.0f} mJ with polynomials of order 2. What "
        "remains is the numerical side's own delay, which the controller cannot see. A motor delay misjudged "
        f"by 5 ms leaves {left[0]:+.2f} or {left[-1]:+.2f} J. The price is noise: with the reference noise "
        f"of the sensors, {noise[0]:.3f} N in the force become {noise[1]:.3f} N with the linear terms, which "
        f"use the measured velocity, and {noise[2]:.3f} N with polynomials."
    )


def draw(numbers: Numbers) -> Figure:
    """Decay, error against the ideal system, energy by term."""
    columns = numbers.tables["position"]
    t, ideal = columns["t [s]"], columns["x1 ideal [m]"]
    figure, axes = panels(3, height=4.9, height_ratios=[1.3, 1.0, 1.2])
    top, middle, low = axes[:, 0]
    top.plot(t, ideal, **IDEAL, label="ideal")
    for way, look in reversed(WAYS):
        label = {"none": "no prediction"}.get(way, way)
        top.plot(t, columns[f"x1 {way} [m]"], **look, label=label)
        middle.plot(t, (columns[f"x1 {way} [m]"] - ideal) * 1e3, **look)
    top.set(ylabel=r"position of $M_1$  (m)")
    middle.set(ylabel=r"$x_1-x_1'$  (mm)")
    legend_above(top, 2)
    for one in (top, middle):
        over_time(one, DURATION)
    top.set_xlabel("")
    _bars(low, numbers.values)
    return figure


def _bars(axes: Axes, values: Mapping[str, float]) -> None:
    """Work by term; the lines show the spread over all sets."""
    places = np.arange(len(WAYS))
    for k, term in enumerate(TERMS):
        work, least, largest = (
            np.array([values[f"{term} {way}, {which} [J]"] for way, _ in WAYS])
            for which in ("at 20 s", "least over all sets", "largest over all sets")
        )
        at = places + 0.22 * (k - 1.5)
        axes.bar(at, work, 0.2, color=TERM_COLOURS[term], label=TERM_NAMES[term])
        axes.vlines(at, least, largest, color="#222222", linewidth=0.7)
        for x, value, low, high in zip(at, work, least, largest, strict=True):
            end, side = (high, "bottom") if value >= 0.0 else (low, "top")
            axes.text(x, end + np.copysign(0.06, value), f"{value:.2f}", ha="center", va=side, fontsize=5.2)
    axes.axhline(0.0, color="#222222", linewidth=0.6)
    axes.set_xticks(places, ["no prediction", "taylor", "polynomial"])
    axes.grid(visible=False, axis="x")
    axes.set(ylabel="work in 20 s  (J)", ylim=(-2.9, 1.6))
    axes.legend(loc="lower right", ncols=2)


FIGURE = Plate(
    "prediction",
    "Not drawn in the paper: with and without forward prediction",
    "The paper advises some form of forward prediction, by the linear error terms or by polynomials.",
    True,
    compute,
    found,
    draw,
)
