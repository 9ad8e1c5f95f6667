"""Fig. 13: responses of x1 and x2 to loads on M1 and M2."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import CHOSEN, OTHERS
from rthm_analysis.reproduce.figure11 import WAYS
from rthm_analysis.reproduce.frequency import grid, responses, unwrapped
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import DOUBLE, OTHER_SET, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAIRS = tuple((output, load) for output in range(2) for load in range(2))


def _decibel(values: np.ndarray) -> np.ndarray:
    return np.asarray(20.0 * np.log10(np.abs(values)))


def _name(output: int, load: int) -> str:
    return f"x{output + 1} of w{load + 1}"


def compute() -> Numbers:
    """Magnitude in dB (of m/N) and phase of all four, five ways."""
    tables: dict[str, dict[str, np.ndarray]] = {}
    found, values = responses()[CHOSEN], {}
    for output, load in PAIRS:
        columns: dict[str, np.ndarray] = {"omega [rad/s]": grid()}
        for way, all_values in found.ways.items():
            columns[f"magnitude {way} [dB]"] = _decibel(all_values[:, output, load])
            columns[f"phase {way} [deg]"] = unwrapped(np.angle(all_values[:, output, load]))
        for one in OTHERS:
            other = responses()[one].ways["sampled"][:, output, load]
            columns[f"magnitude sampled [dB], {one.label}"] = _decibel(other)
        name = _name(output, load)
        tables[name] = columns
        error = np.abs(columns["magnitude delays [dB]"] - columns["magnitude sampled [dB]"])
        with_holds = np.abs(columns["magnitude delays_and_holds [dB]"] - columns["magnitude sampled [dB]"])
        values[f"largest deviation of (28)-(30) from the sampled loop, {name} [dB]"] = float(error.max())
        values[f"the same with tau', {name} [dB]"] = float(with_holds.max())
    return Numbers(tables, values)


def found(numbers: Numbers) -> str:
    """What the holds are worth."""
    without = max(value for name, value in numbers.values.items() if name.startswith("largest"))
    with_holds = max(value for name, value in numbers.values.items() if name.startswith("the same"))
    return (
        f"Over all four responses (28)-(30), which leave the holds out, deviate from the exact sampled loop "
        f"by up to {without:.1f} dB; with tau' in place of tau by {with_holds:.2f} dB."
    )


def draw(numbers: Numbers) -> Figure:
    """Magnitude and phase for every pair of load and position."""
    figure, axes = panels(
        4, 2, height=6.2, width=DOUBLE, sharex=True, sharey="row", height_ratios=[1.5, 1.0, 1.5, 1.0]
    )
    for output, load in PAIRS:
        columns = numbers.tables[_name(output, load)]
        omega, top, low = columns["omega [rad/s]"], axes[2 * output, load], axes[2 * output + 1, load]
        for name, values in columns.items():
            if "M2" in name:
                top.plot(omega, values, **OTHER_SET)
        for way, look, label in WAYS:
            top.plot(omega, columns[f"magnitude {way} [dB]"], **look, label=label)
            low.plot(omega, columns[f"phase {way} [deg]"], **look)
        top.plot([], [], **OTHER_SET, label="sampled, other sets")
        top.set_title(rf"from $\omega_{load + 1}$ to $x_{output + 1}$")
        top.set_xscale("log")
        low.set_xlim(omega[0], omega[-1])
        low.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
        low.set_xticks([], minor=True)
    for row in range(4):
        axes[row, 0].set_ylabel("phase  (deg)" if row % 2 else "magnitude  (dB of m/N)")
        if row % 2:
            axes[row, 0].set_yticks([-360, -270, -180, -90, 0])
    for column in range(2):
        axes[3, column].set_xlabel(r"$\omega$  (rad/s)")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4)
    return figure


FIGURE = Plate(
    "figure13",
    "Fig. 13: Bode matrix",
    "The Bode matrix of (28)-(30) from both loads to both positions shows the same: accurate away from the "
    "natural frequencies, damped at them.",
    True,
    compute,
    found,
    draw,
)
