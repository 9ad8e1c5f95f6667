"""Fig. 11: response of x1 to a load on M1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import CHOSEN, OTHERS
from rthm_analysis.reproduce.frequency import MARKED, grid, responses, unwrapped
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import HYBRID, IDEAL, OTHER_SET, TAYLOR, legend_above, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WAYS = (("ideal", IDEAL, "ideal"), ("sampled", HYBRID, "sampled, exact"), ("delays", TAYLOR, "(28)-(30)"))


def compute() -> Numbers:
    """Magnitude and phase, five ways; the exact loop for every other set."""
    found, omega = responses()[CHOSEN], grid()
    columns: dict[str, np.ndarray] = {"omega [rad/s]": omega}
    for way, response in found.ways.items():
        columns[f"magnitude {way} [m/N]"] = np.abs(response[:, 0, 0])
        columns[f"phase {way} [deg]"] = unwrapped(np.angle(response[:, 0, 0]))
    others: dict[str, np.ndarray] = {"omega [rad/s]": omega}
    for one in OTHERS:
        others[f"magnitude sampled [m/N], {one.label}"] = np.abs(responses()[one].ways["sampled"][:, 0, 0])
    peak = {way: columns[f"magnitude {way} [m/N]"] for way in found.ways}
    low = omega < 3.0
    values = {f"peak {way} [m/N]": float(peak[way][low].max()) for way in peak}
    values["resonance of the sampled loop [rad/s]"] = float(omega[low][np.argmax(peak["sampled"][low])])
    at = int(np.argmin(np.abs(omega - MARKED[0])))
    values["deviation of the sampled loop from the ideal at 1 rad/s"] = float(
        abs(peak["sampled"][at] / peak["ideal"][at] - 1.0)
    )
    values["deviation of (28)-(30) from the sampled loop at the peak"] = (
        values["peak delays [m/N]"] / values["peak sampled [m/N]"] - 1.0
    )
    return Numbers({"response": columns, "other sets": others}, values)


def found(numbers: Numbers) -> str:
    """Inside and outside resonance."""
    v = numbers.values
    share = v["peak sampled [m/N]"] / v["peak ideal [m/N]"]
    return (
        f"At resonance the hybrid system reaches {100 * share:.0f} % of the ideal amplitude, at 1 rad/s it "
        f"is within {100 * v['deviation of the sampled loop from the ideal at 1 rad/s']:.1f} %. Without "
        f"holds, (28)-(30) read {100 * v['deviation of (28)-(30) from the sampled loop at the peak']:.0f} % "
        "above the exact sampled loop at the peak."
    )


def draw(numbers: Numbers) -> Figure:
    """Magnitude (abs) above, phase below."""
    columns, others = numbers.tables["response"], numbers.tables["other sets"]
    omega = columns["omega [rad/s]"]
    figure, axes = panels(2, height=3.3, sharex=True, height_ratios=[1.6, 1.0])
    top, low = axes[:, 0]
    for name, values in others.items():
        if name != "omega [rad/s]":
            top.plot(omega, values, **OTHER_SET)
    for way, look, label in WAYS:
        top.plot(omega, columns[f"magnitude {way} [m/N]"], **look, label=label)
        low.plot(omega, columns[f"phase {way} [deg]"], **look)
    top.plot([], [], **OTHER_SET, label="sampled, other sets")
    marked = np.isin(omega, MARKED)
    for one, what in ((top, "magnitude sampled [m/N]"), (low, "phase sampled [deg]")):
        one.plot(omega[marked], columns[what][marked], "o", color=HYBRID["color"], markersize=3.0)
    top.set(ylabel=r"$|x_1/\omega_1|$  (m/N)", xscale="log", ylim=(0.0, None))
    legend_above(top, 2)
    low.set(xlabel=r"$\omega$  (rad/s)", ylabel="phase  (deg)", xlim=(omega[0], omega[-1]))
    low.set_yticks([-360, -270, -180, -90, 0])
    low.set_ylim(min(-185.0, min(float(columns[f"phase {way} [deg]"].min()) for way, *_ in WAYS)) - 5.0, 5.0)
    low.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    low.set_xticks([], minor=True)
    return figure


FIGURE = Plate(
    "figure11",
    "Fig. 11: response of x1 to a load on M1",
    "Outside the natural frequencies the delayed system is accurate; at them the induced damping takes much "
    "of the amplitude.",
    True,
    compute,
    found,
    draw,
)
