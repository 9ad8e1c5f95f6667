"""Page of a comparison: verdict, overlays, differences, measures and what they are. It computes nothing."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from rthm_analysis.bag_analysis import to_json
from rthm_analysis.comparison import rows
from rthm_analysis.comparison.difference import part
from rthm_analysis.comparison.measures import DEFINITIONS, SOURCES
from rthm_analysis.report.embedding import script_safe
from rthm_analysis.report.page import USE_LINKED, Section, assemble, fact_boxes, foot, note_list, write_page
from rthm_analysis.report.tables import table, with_symbols
from rthm_analysis.report.verdict import BAD, GOOD, NOTED, Fact

if TYPE_CHECKING:
    from rthm_analysis.comparison import Comparison

SPACE = "\N{NO-BREAK SPACE}"

LEVELS = {True: GOOD, False: BAD, None: NOTED}


def write_comparison(comparison: Comparison, html: str | Path) -> None:
    """Write the page about a comparison; it needs no other file and no network.

    Raises
    ------
    InputError
        The page cannot be written.
    """
    write_page(comparison_page(comparison), html)


def comparison_page(comparison: Comparison) -> str:
    """Page as text."""
    others = ", ".join(one.name for one in comparison.against)
    title = f"Comparison: {others} against {comparison.reference.name}"
    numbers = script_safe(to_json(comparison.as_dict()))
    data = f'<script type="application/json" id="comparison">{numbers}</script>'
    return assemble(title, _header(title, comparison), _sections(comparison), foot(USE_LINKED), data)


def _header(title: str, comparison: Comparison) -> str:
    told = "; ".join(one.motion.words for one in comparison.told)
    answer = f'<p class="answer">{escape(comparison.words[:1].upper() + comparison.words[1:])}</p>'
    boxes = fact_boxes(_facts(comparison))
    return f"<header><h1>{escape(title)}</h1>{answer}<p>{escape(told)}</p>{boxes}</header>"


def _facts(comparison: Comparison) -> list[Fact]:
    facts = [Fact("Verdict", _verdict(comparison), comparison.words, LEVELS[comparison.within])]
    for one in comparison.against:
        for name, difference in one.judged.items():
            words = f"Root mean square of the difference of {name}, over that of the reference."
            allowed = comparison.tolerance
            level = NOTED if allowed is None else LEVELS[difference.far <= allowed]
            facts.append(Fact(f"{name} of {one.name}", part(difference.nrmse), words, level))
    return facts


def _verdict(comparison: Comparison) -> str:
    if comparison.tolerance is None or comparison.within is None:
        return f"not{SPACE}judged"
    word = "within" if comparison.within else "beyond"
    return f"{word}{SPACE}{100.0 * comparison.tolerance:.4g}{SPACE}%"


def _sections(comparison: Comparison) -> list[Section]:
    from rthm_analysis.report.comparison_figures import overlays

    notes = dict.fromkeys(
        f"{one.motion.name}: {note}" for one in comparison.told for note in one.motion.notes
    )
    return [
        *(
            Section(
                f"{one.name} against {comparison.reference.name}",
                f"Aligned at their starts, over {one.begin:.4g} to {one.end:.4g} s. Time offset:"
                f" {with_symbols(rows.seconds(one.offset))}.",
                [_table(rows.difference_rows(one))],
                "how-to/compare-tests#measures",
            )
            for one in comparison.against
        ),
        Section(
            "Tracking",
            "How well the actuators tracked their commands, in each test.",
            [_table(rows.tracking_rows(comparison))],
            "how-to/compare-tests#measures",
        ),
        Section(
            "Delays",
            "Effective delays, holds included.",
            [_table(rows.delay_rows(comparison))],
            "how-to/compare-tests#measures",
        ),
        Section(
            "Energy",
            "Work on the moving masses until the end.",
            [_table(rows.energy_rows(comparison))],
            "how-to/compare-tests#measures",
        ),
        Section(
            "Signals",
            "Each signal in all tests, and the differences.",
            overlays(comparison, energies=False),
            "how-to/compare-tests#signals",
        ),
        Section(
            "Energy over time",
            "Each term of the energy balance in all tests, and the differences.",
            overlays(comparison, energies=True),
            "how-to/compare-tests#signals",
            "Show the curves",
        ),
        Section("What is measured", "", [_definitions()], "how-to/compare-tests#measures"),
        Section("Notes", "", [note_list(list(notes))] if notes else []),
    ]


def _table(told: list[rows.Row]) -> str:
    shown = [[with_symbols(cell) for cell in row] for row in told]
    return table(shown[0], shown[1:]) if shown else ""


def _definitions() -> str:
    told = table(("measure", "is", "from"), ((name, *words) for name, words in DEFINITIONS.items()))
    return told + note_list(SOURCES)
