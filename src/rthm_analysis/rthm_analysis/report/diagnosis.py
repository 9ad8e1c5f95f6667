"""Page of a diagnosis: where, what, how big, how sure, and how much better. It computes nothing."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from contextlib import suppress
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.numbers import percent
from rthm_analysis.diagnosis.result import Diagnosis
from rthm_analysis.diagnosis.words import block_words, retuned_words, stated_spreads
from rthm_analysis.report import diagnosis_lists as lists
from rthm_analysis.report import diagnosis_tables as tables
from rthm_analysis.report.diagnosis_drawing import drawing
from rthm_analysis.report.embedding import script_safe
from rthm_analysis.report.page import (
    USE,
    Section,
    assemble,
    fact_boxes,
    foot,
    note_list,
    write_page,
)
from rthm_analysis.report.tables import with_symbols
from rthm_analysis.report.verdict import BAD, GOOD, NOTED, Fact
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.spec import Spec

LEVELS = {"match": GOOD, "retuned": GOOD, "explained": NOTED, "improved": NOTED, "unexplained": BAD}

ARROW = "\N{NO-BREAK SPACE}→\N{NO-BREAK SPACE}"

DELAY_TERMS = ("E_fx", "E_ff", "E_num")
"""Work of the delays of the loop (`energy_of`)."""


def write_diagnosis(diagnosis: Diagnosis, recording: Recording, spec: Spec, html: str | Path) -> None:
    """Write the page about a diagnosis; it needs no other file and no network.

    Raises
    ------
    InputError
        The page cannot be written.
    """
    write_page(diagnosis_page(diagnosis, recording, spec), html)


def diagnosis_page(diagnosis: Diagnosis, recording: Recording, spec: Spec) -> str:
    """Page as text."""
    numbers = script_safe(json.dumps(_plain(diagnosis.as_dict()), allow_nan=False))
    data = f'<script type="application/json" id="diagnosis">{numbers}</script>'
    title, end = f"Diagnosis: {_names(diagnosis, recording)}", foot(USE, recording.spec_text)
    header, sections = _header(title, diagnosis, spec), _sections(diagnosis, recording, spec)
    return assemble(title, header, sections, end, data)


def _names(diagnosis: Diagnosis, recording: Recording) -> str:
    return ", ".join(one.name for one in diagnosis.recordings) or recording.name


def _sections(diagnosis: Diagnosis, recording: Recording, spec: Spec) -> list[Section]:
    from rthm_analysis.report import diagnosis_figures as figures

    found, delays = _work_found(diagnosis), _work_of_delays(recording, spec)
    patched = (
        f"<details><summary>Show the spec</summary><pre>{escape(diagnosis.patched.strip())}</pre></details>"
    )
    return [
        Section(
            "Where",
            "Each block is predicted from its recorded inputs. 1 x noise: error no larger than the noise. "
            "Unframed blocks deviate only because a framed one does.",
            [drawing(diagnosis, recording, spec), tables.mismatches(diagnosis)],
            "diagnosis#how-to-read-the-answer",
        ),
        Section(
            "Faults of the recording or its spec",
            "",
            [lists.faults(diagnosis)],
            "diagnosis#faults-of-the-recording",
        ),
        Section(
            "What",
            "",
            [tables.physics(diagnosis), tables.retuned(diagnosis), lists.traces(diagnosis)],
            "diagnosis#how-to-read-the-answer",
        ),
        Section(
            "Forces without a name",
            "The data show these forces; no known kind of effect fits them.",
            [
                lists.described(diagnosis),
                *([figures.described_plot(one)] for one in diagnosis.described if one.at.size),
            ],
            "diagnosis#how-it-works",
        ),
        Section(
            "The missing force",
            "Large dots: averages over the recording, with one standard deviation. "
            "Small dots: the effect that was found, at single samples.",
            [[figures.curve_plot(curve)] for curve in diagnosis.curves],
            "diagnosis#how-it-works",
            "Show what is left: no more than the noise" if diagnosis.verdict == "match" else "",
        ),
        Section(
            "Recording by recording",
            "One model for all; each begins in a state of its own. The last chose and fitted nothing.",
            [tables.recordings(diagnosis)] if diagnosis.recordings else [],
            "diagnosis#several-recordings",
        ),
        Section(
            "Before and after, on held-out data",
            "Simulated from the recorded inputs; no fit has used these data. The first few cycles are shown: "
            "zoom out for the rest.",
            [
                tables.fits(diagnosis),
                tables.free_runs(diagnosis),
                *([plot] for fit in diagnosis.fits for plot in figures.fit_plots(fit)),
            ],
            "diagnosis#how-to-read-the-answer",
        ),
        Section(
            "Energy",
            "Work over the whole recording: of what was found"
            + (", and of the delays of the loop." if delays else "."),
            [[figures.energy_plot(found, delays)]] if found or delays else [],
            "diagnosis#how-to-read-the-answer",
        ),
        Section(
            "What else it could be",
            "",
            [tables.alternatives(diagnosis), lists.refused(diagnosis)],
            "diagnosis#how-to-read-the-answer",
        ),
        Section("What to do next", "", lists.next_test(diagnosis), "diagnosis#how-to-read-the-answer"),
        Section(
            "Detection limits",
            "The smallest effects that this recording could have shown.",
            [tables.limits(diagnosis)],
            "diagnosis#how-to-read-the-answer",
        ),
        Section(
            "Notes",
            "",
            [note_list(diagnosis.notes)] if diagnosis.notes else [],
            "diagnosis#what-it-cannot-do",
        ),
        Section(
            "Patched spec",
            "The spec with the effects and values that were found.",
            [patched] if diagnosis.patched and diagnosis.verdict != "match" else [],
            "diagnosis#how-to-read-the-answer",
        ),
    ]


def _header(title: str, diagnosis: Diagnosis, spec: Spec) -> str:
    said = [one.words for one in diagnosis.physics]
    if diagnosis.retuned:
        said.append(f"{retuned_words(diagnosis.retuned, stated_spreads(spec))}.")
    said += diagnosis.unexplained
    findings = "".join(f"<li>{escape(with_symbols(one))}</li>" for one in said)
    answer = f'<p class="answer">{escape(_answer(diagnosis))}</p>'
    listed = f'<ol class="findings">{findings}</ol>' if findings else ""
    return f"<header><h1>{escape(title)}</h1>{answer}{fact_boxes(_facts(diagnosis))}{listed}</header>"


def _explanation(diagnosis: Diagnosis) -> str:
    """Return what explains the difference, in half a sentence."""
    if diagnosis.physics:
        return "the physics that was left out is named below."
    if any(one.formula or one.held_out_gain > 0.0 for one in diagnosis.described):
        return "the force that was left out has no name, and its formula is below."
    if diagnosis.described:
        return "something that nobody recorded pushed it: when, and with what, is below."
    return "what is wrong with the recording is named below."


def _answer(diagnosis: Diagnosis) -> str:
    """Return the verdict in a sentence."""
    where = enumerated(block_words(block) for block in diagnosis.located)
    differ = f"Simulation and recording differ in {where}"
    if diagnosis.verdict == "explained":
        return f"{differ}; {_explanation(diagnosis)}"
    if diagnosis.verdict == "improved" and not diagnosis.physics and diagnosis.described:
        return f"{differ}; the force that is missing has no name and is described below."
    if diagnosis.verdict == "improved":
        return (
            f"{differ}; the physics named below explains part of the difference, and the rest is above "
            "the noise."
        )
    if diagnosis.verdict == "unexplained":
        return f"{differ}, and no known kind of physics explains it."
    if diagnosis.verdict == "retuned":
        return "No physics is missing; parameters have other values than the spec says."
    return diagnosis.words


def _facts(diagnosis: Diagnosis) -> list[Fact]:
    facts = [Fact("Verdict", diagnosis.verdict, diagnosis.words, LEVELS[diagnosis.verdict])]
    for one in diagnosis.physics:
        facts.append(Fact(one.block, one.kind.replace("_", "\N{NO-BREAK SPACE}"), one.words))
    for fit in diagnosis.fits[:1]:
        before, after, noise = (
            percent(fit.nrmse.get(name, math.nan), 3) for name in ("nominal", "explained", "noise_floor")
        )
        words = f"Error of {fit.signal} on held-out data; the noise alone gives {noise}."
        told = before if diagnosis.verdict == "match" else f"{before}{ARROW}{after}"
        facts.append(Fact(f"Held-out error of {fit.signal}", told, words))
    return facts


def _work_found(diagnosis: Diagnosis) -> dict[str, float]:
    """Work of what was found, J; alike effects together."""
    terms: dict[str, float] = {}
    for one in diagnosis.physics:
        if math.isfinite(one.energy):
            name = f"{one.kind.replace('_', ' ')} ({one.block})"
            terms[name] = terms.get(name, 0.0) + one.energy
    return terms


def _work_of_delays(recording: Recording, spec: Spec) -> dict[str, float]:
    """Work of the terms of the delays, J; none where the loop is not known or not recorded."""
    from rthm_analysis.energy import energy_of
    from rthm_analysis.report.figures import TERM_WORDS

    if not spec.is_loop:
        return {}
    with suppress(InputError):
        work = energy_of(recording, spec).work
        last = {f"{TERM_WORDS[name]} ({name})": float(work[name][-1]) for name in DELAY_TERMS}
        return {name: work for name, work in last.items() if math.isfinite(work)}
    return {}


def _plain(value: Any) -> Any:
    """Value in the types of JSON; what is not finite becomes null."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
