"""Put the page together: one HTML file with everything in it, the numbers too."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.bag_analysis import to_json
from rthm_analysis.recording import Recording
from rthm_analysis.report import tables
from rthm_analysis.report.documentation import address
from rthm_analysis.report.embedding import Embedding, script_safe
from rthm_analysis.report.gathered import Gathered, gather
from rthm_analysis.report.loop_drawing import draw_loop
from rthm_analysis.report.provenance import provenance
from rthm_analysis.report.verdict import Fact, verdict
from rthm_core.clock import EARLIEST_YEAR, NS
from rthm_core.events import Abort
from rthm_core.files import not_written, write_whole

if TYPE_CHECKING:
    from bokeh.plotting import figure

USE = "Drag to zoom in, “all” goes back; click a name to hide its curve."
USE_LINKED = f"{USE} All time axes move together."


@dataclass(frozen=True)
class Section:
    """Part of a page: a heading, a line of explanation, and rows of plots or pieces of HTML.

    `about` is the part of the documentation that explains it (`documentation.address`). With words in
    `folded` the parts are shown when somebody opens these words.
    """

    title: str
    words: str
    parts: Sequence[str | list[figure]]
    about: str = ""
    folded: str = ""


def write_report(bag: Recording | str | Path, html: str | Path, abort: Abort | None = None) -> Gathered:
    """Write the page about a recorded test; return what it shows.

    Parameters
    ----------
    bag : Recording, str or Path
        The recording, or its folder or file.
    html : str or Path
        Where the page goes. It needs no other file and no network.
    abort : Abort, optional
        What ended the test, where it was not recorded any more.

    Raises
    ------
    InputError
        The recording cannot be read, or the page cannot be written.
    """
    gathered = gather(bag, abort)
    write_page(page(gathered), html)
    return gathered


def write_page(text: str, html: str | Path) -> None:
    """Write a page; InputError when it cannot be written."""
    try:
        Path(html).parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise not_written(html, error) from None
    write_whole(html, text)


def page(gathered: Gathered) -> str:
    """Page as text."""
    return assemble(
        _title(gathered),
        _header(gathered),
        _sections(gathered),
        foot(USE_LINKED, gathered.recording.spec_text),
        _numbers(gathered),
    )


def assemble(title: str, header: str, sections: Sequence[Section], footer: str, numbers: str) -> str:
    """Page from its parts, which are HTML but for the title; sections with nothing in them are left out."""
    embedding = Embedding()
    sections = [section for section in sections if any(section.parts)]
    body = "".join(_section(section, embedding) for section in sections)
    style = (files(__package__) / "page.css").read_text(encoding="utf-8")
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(title)}</title>"
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{style}</style></head><body><main>{header}{contents(one.title for one in sections)}{body}"
        f"{footer}</main>{numbers}{embedding.scripts()}</body></html>\n"
    )


def contents(titles: Iterable[str]) -> str:
    """Links to the sections of a page."""
    links = "".join(f'<a href="#{anchor(title)}">{escape(title)}</a>' for title in titles)
    return f'<nav class="contents" aria-label="Contents">{links}</nav>'


def anchor(title: str) -> str:
    """Name by which a section is found within its page."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def _sections(gathered: Gathered) -> list[Section]:
    from rthm_analysis.report import figures  # a second of bokeh, which who only asks for the verdict saves

    clocks: list[str | list[figure]]
    span, spec, timing = figures.time_axis(gathered), gathered.spec, gathered.timing
    loop = [draw_loop(spec, timing)] if spec and spec.is_loop else []
    single = [[plot] for plot in figures.motion(gathered, span)]
    force = [[plot] for plot in figures.forces(gathered, span)]
    energy = [[plot] for plot in figures.energies(gathered, span)]
    delays = [*figures.rows(figures.ages(gathered)), *figures.rows(figures.excesses(gathered))]
    clocks = [tables.clocks(timing), *figures.rows(figures.periods(gathered))] if timing.clocks else []
    return [
        Section(
            "The loop",
            "Delay of each link as specified, and the age of its samples when they were used.",
            loop,
            "how-to/read-a-report#the-loop",
        ),
        Section("Motion", "", single, "how-to/read-a-report#motion"),
        Section("Force", "", force, "how-to/read-a-report#force"),
        Section("Energy", _closing(gathered), energy, "how-to/read-a-report#energy"),
        Section(
            "Delays",
            "Age: from sampling to use, holds included. Excess: by how much it exceeds the exact schedule; "
            "drawn for links that have any.",
            [tables.links(timing), *delays] if timing.links else [],
            "how-to/read-a-report#delays",
        ),
        Section(
            "Clocks",
            "Measured time between ticks; drawn for clocks with ticks that were not on time.",
            clocks,
            "how-to/read-a-report#clocks",
        ),
        Section(
            "Notes", "", [note_list(gathered.notes)] if gathered.notes else [], "how-to/read-a-report#notes"
        ),
        Section(
            "Spec",
            "The spec of the test.",
            [_spec(gathered)] if spec else [],
            "how-to/read-a-report#spec",
        ),
    ]


def _closing(gathered: Gathered) -> str:
    """Return what energy is counted on, and how well its balance closes."""
    from rthm_analysis.report import figures

    words = "Work done on the moving masses since the start of the test."
    if gathered.energy is None:
        return words
    error = gathered.energy.balance_error
    if figures.only_rounding(error, gathered.energy.total):
        return f"{words} The balance closes to rounding."
    return f"{words} Largest balance error: {np.nanmax(np.abs(error)):.2g} J."


def _section(section: Section, embedding: Embedding) -> str:
    words = f"<p>{escape(section.words)}</p>" if section.words else ""
    shown = "".join(part if isinstance(part, str) else embedding.row(part) for part in section.parts)
    if section.folded:
        shown = f"<details><summary>{escape(section.folded)}</summary>{shown}</details>"
    head = f"<h2>{escape(section.title)}</h2>{_explained(section)}{words}"
    return f'<section id="{anchor(section.title)}">{head}{shown}</section>'


def _explained(section: Section) -> str:
    """Link from a heading to the documentation."""
    href = address(section.about) if section.about else ""
    label = escape(f"{section.title}: explained in the documentation", quote=True)
    return (
        f'<a class="about" href="{escape(href, quote=True)}" aria-label="{label}">explained</a>'
        if href
        else ""
    )


def _title(gathered: Gathered) -> str:
    kind = "Hybrid test" if gathered.spec and gathered.spec.is_loop else "Test of a plant"
    return f"{kind}: {gathered.recording.name}"


def _header(gathered: Gathered) -> str:
    recording = gathered.recording
    begin = datetime.fromtimestamp(recording.start_ns / NS, UTC)
    when = f"from {begin:%Y-%m-%d %H:%M:%S} UTC" if begin.year > EARLIEST_YEAR else "in simulated time"
    facts = fact_boxes(verdict(gathered.energy, gathered.timing, gathered.outcome))
    words = f"{recording.duration:.3f} s {when}, {len(recording.plant)} samples of the plant"
    abort = f'<p class="abort">{escape(gathered.abort.sentence)}</p>' if gathered.abort else ""
    said = "".join(f"<p>{escape(line)}</p>" for line in gathered.outcome.lines()) if gathered.outcome else ""
    return f"<header>{abort}<h1>{escape(_title(gathered))}</h1><p>{words}</p>{said}{facts}</header>"


def fact_boxes(facts: Iterable[Fact]) -> str:
    """Boxes with one figure each."""
    boxes = "".join(
        f'<div class="fact {fact.level}" title="{escape(fact.words)}"><span>{escape(fact.label)}</span>'
        f"<b>{_unit_small(fact.value)}</b></div>"
        for fact in facts
    )
    return f'<div class="facts">{boxes}</div>'


def _unit_small(value: str) -> str:
    """Figure with its unit in smaller letters."""
    number, _, unit = value.partition(" ")
    return f"{escape(number)} <small>{escape(unit)}</small>" if unit else escape(number)


def foot(words: str, spec: str = "") -> str:
    """Foot of a page: how to use it, and what it was made of."""
    return f"<footer><p>{words}</p>{provenance(spec)}</footer>"


def note_list(notes: Sequence[str]) -> str:
    """Notes as a list."""
    return f'<ul class="notes">{"".join(f"<li>{escape(note)}</li>" for note in notes)}</ul>'


def _spec(gathered: Gathered) -> str:
    text = escape(gathered.recording.spec_text.strip())
    return f"<details><summary>Show the spec</summary><pre>{text}</pre></details>"


def _numbers(gathered: Gathered) -> str:
    """Return the results as JSON, for programs that read the page."""
    results: dict[str, Any] = {"timing": gathered.timing.as_dict()}
    if gathered.energy is not None:
        results["energy"] = gathered.energy.as_dict()
    if gathered.outcome is not None:
        results["verdict"] = gathered.outcome.as_dict()
    return "".join(
        f'<script type="application/json" id="{name}">{script_safe(to_json(result))}</script>'
        for name, result in results.items()
    )
