"""Tables I, II and III."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.reproduce.candidates import ALL, CHOSEN, Candidate, modes, paper
from rthm_analysis.reproduce.figure12 import amplitude, excited
from rthm_analysis.reproduce.frequency import MARKED, grid, responses
from rthm_analysis.response import WAYS
from rthm_core.spec import shipped_spec

STEADY_AFTER = 240.0
"""Length of a simulation whose steady state is measured, s."""


@dataclass(frozen=True)
class Table:
    """A table: its head and its rows; `note` says what to know about it."""

    name: str
    title: str
    note: str
    head: tuple[str, ...]
    rows: tuple[tuple[str | float, ...], ...]

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {"head": list(self.head), "rows": [list(row) for row in self.rows]}


def table1() -> Table:
    """Delays, holds and motor dynamics, as printed and as used."""
    printed, used = shipped_spec("paper_printed").loop().timing, paper().loop().timing
    symbols = {name: name.replace("td", "Td") for name, _ in used.items()}
    rows = [(symbols[name], getattr(printed, name) * 1e3, value * 1e3) for name, value in used.items()]
    return Table(
        "table1",
        "Table I: delays and holds",
        "Td2 and Td3 are swapped against the printed table: only so are the text's 0.66 and -0.22 Ns/m "
        "right. The motor is h(s) = 1.",
        ("parameter", "printed (ms)", "used (ms)"),
        tuple(rows),
    )


def table2() -> Table:
    """Parameters of the two masses, and how sure each is."""
    loop = paper().loop()
    rows: list[tuple[str | float, ...]] = [
        ("M1 (kg)", loop.plant.mass[0], "printed"),
        ("M2 (kg)", loop.numerical.mass[0], "not recoverable: this project's choice"),
        ("c1 (Ns/m)", loop.plant.damping[0], "printed, order assumed"),
        ("c2 (Ns/m)", loop.interface.damping[0], "printed, order assumed"),
        ("c3 (Ns/m)", loop.numerical.damping[0], "printed, order assumed"),
        ("k1 (N/m)", loop.plant.stiffness[0], "the only 12, beside the K headers"),
        ("k2 (N/m)", loop.interface.stiffness[0], "follows from -0.22 Ns/m"),
        ("k3 (N/m)", loop.numerical.stiffness[0], "not recoverable: this project's choice"),
        ("k_tot (N/m)", paper().k_tot[0], "in the text"),
    ]
    others = "; ".join(f"({one.M2:g}, {one.k1:g}, {one.k3:g})" for one in ALL if one is not CHOSEN)
    return Table(
        "table2",
        "Table II: parameters",
        f"Other sets (M2, k1, k3) that fit all that the text says: {others}.",
        ("parameter", "value", "how sure"),
        tuple(rows),
    )


def _at(omega: float, one: Candidate, way: str) -> tuple[float, float]:
    row = int(np.argmin(np.abs(grid() - omega)))
    value = complex(responses()[one].ways[way][row, 0, 0])
    return abs(value), float(np.angle(value, deg=True))


def table3() -> Table:
    """Steady response of x1 to a load of 1 N on M1: from theory five ways, and as simulated."""
    rows: list[tuple[str | float, ...]] = []
    for omega in MARKED:
        for way in WAYS:
            sets = [_at(omega, one, way)[0] for one in ALL]
            size, phase = _at(omega, CHOSEN, way)
            rows.append((f"{omega:g} rad/s, {way}", size, phase, min(sets), max(sets)))
        simulated = [amplitude(excited(one, omega, "hybrid", STEADY_AFTER), omega, 60.0) for one in ALL]
        sizes = [size for size, _ in simulated]
        rows.append((f"{omega:g} rad/s, simulated", *simulated[0], min(sizes), max(sizes)))
    return Table(
        "table3",
        "Table III: frequency response at the sample points",
        "Empty in the text that is left of the paper, so nothing can be compared number by number. “delays” "
        "is (28)-(30), “delays_and_holds” the same with tau', “sampled” the exact multirate loop.",
        (
            "frequency and way",
            "amplitude (m/N)",
            "phase (deg)",
            "least over all sets",
            "largest over all sets",
        ),
        tuple(rows),
    )


def sets() -> Table:
    """The sets that fit, with their natural frequencies."""
    rows: list[tuple[str | float, ...]]
    rows = [(f"{one.M2:g}", one.k1, one.k3, *(float(w) for w in modes(one))) for one in ALL]
    return Table(
        "sets",
        "The five candidate sets",
        "All have one mode near 2.4 rad/s. The first is what every figure is drawn with.",
        ("M2 (kg)", "k1 (N/m)", "k3 (N/m)", "mode 1 (rad/s)", "mode 2 (rad/s)"),
        tuple(rows),
    )
