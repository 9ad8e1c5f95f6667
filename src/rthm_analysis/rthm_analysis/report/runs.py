"""Page of an index of runs. It computes nothing."""

from __future__ import annotations

import os
from collections.abc import Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

from rthm_analysis.report.page import Section, assemble, fact_boxes, foot, note_list, write_page
from rthm_analysis.report.verdict import BAD, GOOD, NOTED, Fact
from rthm_analysis.runs import Run
from rthm_analysis.runs.rows import rows


def write_runs(runs: Sequence[Run], folder: Path, html: Path) -> None:
    """Write the page about a folder of runs; it links to their reports.

    Raises
    ------
    InputError
        The page cannot be written.
    """
    title = f"Runs in {folder}"
    head = f"<header><h1>{escape(title)}</h1>{fact_boxes(_facts(runs))}</header>"
    said = [f"{run.name}: {one}" for run in runs for one in run.problems]
    sections = [
        Section(
            "Index",
            "Error: rms of the dof that is furthest from the ideal system, over the rms of the ideal motion.",
            [_index(runs, html)],
        ),
        Section("Problems", "", [note_list(said)] if said else []),
    ]
    write_page(assemble(title, head, sections, foot(""), ""), html)


def _facts(runs: Sequence[Run]) -> list[Fact]:
    unsound = sum(bool(run.problems) for run in runs)
    unstable = sum(run.outcome == "unstable" for run in runs)
    return [
        Fact("Runs", str(len(runs)), f"{len(runs)} runs and trajectories.", NOTED),
        Fact("With problems", str(unsound or "none"), "Listed below.", BAD if unsound else GOOD),
        Fact("Unstable", str(unstable or "none"), "Loops that are unstable.", BAD if unstable else GOOD),
    ]


def _index(runs: Sequence[Run], html: Path) -> str:
    head, *body = rows(runs)
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    lines = "".join(_line(run, row, html) for run, row in zip(runs, body, strict=True))
    return f'<div class="wide"><table><thead><tr>{top}</tr></thead><tbody>{lines}</tbody></table></div>'


def _line(run: Run, row: Sequence[str], html: Path) -> str:
    bad = {"outcome": run.outcome in ("unstable", "aborted"), "problems": bool(run.problems)}
    name, *others = row
    cells = [f"<td>{_linked(run, name, html)}</td>"]
    for what, cell in zip(("begun", "length", "outcome", "error", "problems", "spec"), others, strict=True):
        mark = ' class="bad"' if bad.get(what) else ""
        cells.append(f"<td{mark}>{escape(cell)}</td>")
    return f"<tr>{''.join(cells)}</tr>"


def _linked(run: Run, name: str, html: Path) -> str:
    """Name of a run, linked to its report where there is one."""
    report = run.path / "report.html"
    if not report.is_file():
        return escape(name)
    there = quote(os.path.relpath(report.resolve(), html.resolve().parent))
    return f'<a href="{there}">{escape(name)}</a>'
