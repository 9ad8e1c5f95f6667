"""Page of a diagnosis: where, what, how big, how sure, and how much better. It computes nothing."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from contextlib import suppress
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rthm_analysis.diagnosis.result import Diagnosis, Value
from rthm_analysis.report import tables
from rthm_analysis.report.page import Section, assemble, note_list, script_safe, write_page
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.spec import Spec

LEVELS = {"match": "good", "retuned": "good", "explained": "warn", "unexplained": "bad"}

DRAWN_AS = {
    "wire": "motor",
    "sensor.position": "sampling",
    "sensor.velocity": "sampling",
    "sensor.force": "sampling",
}
"""Blocks that share a box of the drawing of the loop with another."""


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
    from rthm_analysis.report import diagnosis_figures as figures

    text = (
        f"<details><summary>Show the spec</summary><pre>{escape(diagnosis.patched.strip())}</pre></details>"
    )
    sections = [
        Section(
            "Where",
            "Blocks whose prediction misses the recording by more than noise.",
            _where(diagnosis, recording, spec),
        ),
        Section("What was left out", "", [_physics(diagnosis), _retuned(diagnosis)]),
        Section(
            "Before and after, on data that no fit has seen",
            "Simulated from the recorded inputs; the lower plot is what is left.",
            [[plot] for fit in diagnosis.fits for plot in figures.fit_plots(fit)],
        ),
        Section(
            "The force that the simulation lacks",
            "Averages over the recording, with one standard deviation.",
            [[figures.curve_plot(curve)] for curve in diagnosis.curves],
        ),
        Section(
            "Energy",
            "Over the recording, in joule; + was put into the masses.",
            [_energy(diagnosis, recording)],
        ),
        Section("What else it could be", "", [_alternatives(diagnosis)]),
        Section("What to try next", diagnosis.next_experiment, [" "]),
        Section(
            "What would have been seen",
            "Smallest effects that this recording would show.",
            [_limits(diagnosis)],
        ),
        Section("Notes", "", [note_list(diagnosis.notes)] if diagnosis.notes else []),
        Section("Spec that behaves as recorded", "", [text]),
    ]
    numbers = script_safe(json.dumps(_plain(diagnosis.as_dict()), allow_nan=False))
    data = f'<script type="application/json" id="diagnosis">{numbers}</script>'
    footer = "<footer>Drag to zoom in, reset to go back, click a name to hide its curve.</footer>"
    return assemble(_title(recording), _header(diagnosis, recording), sections, footer, data)


def _title(recording: Recording) -> str:
    path = recording.path.resolve()
    return f"Diagnosis: {path.parent.name if path.name == 'bag' else path.name}"


def _header(diagnosis: Diagnosis, recording: Recording) -> str:
    facts = [("verdict", diagnosis.verdict, LEVELS[diagnosis.verdict])]
    for one in diagnosis.physics:
        facts.append((one.block, one.kind.replace("_", " "), "warn"))
    boxes = "".join(
        f'<div class="fact {level}"><span>{escape(label)}</span><b>{escape(value)}</b></div>'
        for label, value, level in facts
    )
    words = "".join(f"<p>{escape(said)}</p>" for said in (diagnosis.words, *diagnosis.unexplained))
    return f'<header><h1>{escape(_title(recording))}</h1>{words}<div class="facts">{boxes}</div></header>'


def _where(diagnosis: Diagnosis, recording: Recording, spec: Spec) -> list[str]:
    parts = []
    if spec.is_loop:
        from rthm_analysis.report.loop_drawing import draw_loop
        from rthm_analysis.timing import timing_of

        errors = {one.block: one.mismatch for one in diagnosis.blocks}
        marks = {
            DRAWN_AS.get(
                block, block.removeprefix("link.")
            ): f"{block}: {errors.get(block, math.nan):.3g} x noise"
            for block in diagnosis.located
        }
        with suppress(InputError):
            parts.append(draw_loop(spec, timing_of(recording, spec), marks))
    rows = [
        [one.block, f"!{one.mismatch:.4g}" if one.significant else f"{one.mismatch:.4g}"]
        for one in diagnosis.blocks
    ]
    return [*parts, tables.table(("block", "error over noise"), rows)]


def _physics(diagnosis: Diagnosis) -> str:
    rows = []
    for one in diagnosis.physics:
        for i, (name, value) in enumerate(one.parameters.items()):
            head = [one.block, one.kind.replace("_", " "), one.place or ""] if i == 0 else ["", "", ""]
            told = [value, "", ""] if isinstance(value, str) else _digits(value)
            share = f"{100.0 * one.share:.3g} %" if i == 0 and math.isfinite(one.share) else ""
            rows.append([*head, name.replace("_", " "), *told, share])
    head = ("block", "kind", "at", "parameter", "value", "standard deviation", "unit", "share of the error")
    return tables.table(head, rows) if rows else "<p>Nothing that this recording shows.</p>"


def _digits(value: Value) -> list[str]:
    return [f"{value.value:.5g}", f"{value.std:.2g}", value.unit]


def _retuned(diagnosis: Diagnosis) -> str:
    rows = [
        [name, f"{one.nominal:.5g}", f"{one.value:.5g}", f"{one.std:.2g}"]
        for name, one in diagnosis.retuned.items()
    ]
    return (
        tables.table(("retuned", "as specified", "in this recording", "standard deviation"), rows)
        if rows
        else ""
    )


def _energy(diagnosis: Diagnosis, recording: Recording) -> str:
    rows = [
        [f"{one.block} {one.kind.replace('_', ' ')}", f"{one.energy:+.4g}"]
        for one in diagnosis.physics
        if math.isfinite(one.energy)
    ]
    if recording.spec is not None and recording.spec.is_loop:
        from rthm_analysis.energy import energy_of

        with suppress(InputError):
            books = energy_of(recording, recording.spec)
            words = {"E_fx": "position cancellation", "E_ff": "force feedforward", "E_num": "numerical side"}
            rows += [[f"{name}: {said}", f"{_last(books, name):+.4g}"] for name, said in words.items()]
    return tables.table(("term", "J"), rows) if rows else ""


def _last(books: Any, name: str) -> float:
    values = books.as_dict()[name]
    return float(values[-1]) if len(values) else math.nan


def _alternatives(diagnosis: Diagnosis) -> str:
    rows = [
        [
            one.block,
            one.kind.replace("_", " "),
            f"{one.held_out_nrmse:.4g}" if math.isfinite(one.held_out_nrmse) else "",
            "ruled out" if one.distinguishable else "!cannot be told apart",
        ]
        for one in diagnosis.alternatives
    ]
    return tables.table(("block", "kind", "error on unseen data", "by this recording"), rows) if rows else ""


def _limits(diagnosis: Diagnosis) -> str:
    rows = [[name, f"{one.value:.3g}", one.unit] for name, one in sorted(diagnosis.detection_limits.items())]
    table = tables.table(("effect", "smallest", "unit"), rows) if rows else ""
    return f"<details><summary>Show {len(rows)} effects</summary>{table}</details>" if rows else ""


def _plain(value: Any) -> Any:
    """Value in the types of JSON; what is not finite becomes null."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
