"""``rthm diagnose``: why a recording differs from its simulation."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.options import Bags, Effects, Json, SpecOfBag, recording_of

if TYPE_CHECKING:
    from rthm_analysis.diagnosis import Diagnosis
    from rthm_analysis.diagnosis.result import Fit, RecordingFit

EXAMPLES = (
    "rthm diagnose out/bag",
    "rthm diagnose out/bag --spec rig.yaml --report diagnosis.html --patched patched.yaml",
    "rthm diagnose low/bag middle/bag high/bag --spec rig.yaml",
)


def verb(
    bags: Bags,
    spec: SpecOfBag = None,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="FILE.html", help="Write a page about it.")
    ] = None,
    patched: Annotated[
        Path | None,
        typer.Option(
            "--patched", metavar="SPEC", help="Write the spec with the effects and values that were found."
        ),
    ] = None,
    next_test: Annotated[
        Path | None,
        typer.Option("--next", metavar="SPEC", help="Write the spec of the most informative next test."),
    ] = None,
    effects: Effects = None,
    json: Json = None,
) -> int:
    """Find where a recording, or several, and the simulation differ, and why."""
    from rthm_analysis.diagnosis import diagnose_together
    from rthm_analysis.recording import nominal_spec
    from rthm_bringup.cli.output import put, status
    from rthm_core.files import write_whole

    recordings = [recording_of(bag, effects) for bag in bags]
    nominal = [nominal_spec(one, spec or None, effects or ()) for one in recordings]
    with status("reading") as say:
        found = diagnose_together(recordings, nominal, say)
    notes = dict.fromkeys(note for one in recordings for note in one.notes)
    found = replace(found, notes=(*notes, *found.notes))
    lines = [*_lines(found), *_not_patched(found, patched), *_not_planned(found, next_test)]
    with ExitStack() as every:  # what cannot be written keeps nothing else from being written
        if report:
            from rthm_analysis.report.diagnosis import write_diagnosis

            every.callback(write_diagnosis, found, recordings[0], nominal[0], report)
        for text, path in ((found.patched, patched), (found.next_experiment_spec, next_test)):
            if path and text:
                every.callback(write_whole, path, text)
        every.callback(put, found.as_dict(), lines, json)
    return 1 if found.verdict in ("improved", "unexplained") else 0


def _not_patched(found: Diagnosis, patched: Path | None) -> list[str]:
    if patched is None or found.patched:
        return []
    if found.verdict == "unexplained":
        return [f"{patched} is not written: nothing was found to put into the spec."]
    return [f"{patched} is not written: in a free run the patched spec fits worse than the one given."]


def _not_planned(found: Diagnosis, next_test: Path | None) -> list[str]:
    if next_test is None or found.next_experiment_spec:
        return []
    return [f"{next_test} is not written: the next step is not a test of the rig."]


def _lines(found: Diagnosis) -> Iterator[str]:
    """The answer, how much better it is, what else it could be, what to try next."""
    from rthm_core.effects import effect

    yield f"{found.verdict}: {found.words}"
    yield from found.unexplained
    for fit in found.fits:
        yield _fit(fit)
    for one in found.recordings:
        yield _in_recording(one)
    unclear = [
        f"{effect(a.kind, a.block).called()} ({a.block})" for a in found.alternatives if not a.distinguishable
    ]
    if unclear:
        yield f"this recording cannot distinguish it from: {', '.join(dict.fromkeys(unclear))}"
    yield f"next: {found.next_experiment}"
    yield from found.notes


def _fit(fit: Fit) -> str:
    """Errors of a signal on unseen data."""
    span = "" if fit.window is None else f", in free runs of {fit.window:.3g} s"
    return (
        f"error of {fit.signal} on held-out data ({fit.held_out[0]:.4g} to {fit.held_out[1]:.4g} s{span}), "
        f"over the signal's standard deviation: {_errors(fit.nrmse)}"
    )


def _in_recording(one: RecordingFit) -> str:
    """Errors of the first signal in one of several recordings."""
    signal, nrmse = next(iter(one.nrmse.items()))
    seen = "held out" if one.held_out else "fitted"
    return f"error of {signal} in {one.name} ({seen}): {_errors(nrmse)}"


def _errors(nrmse: dict[str, float]) -> str:
    """Errors of each model that is another than the one before it, and the noise."""
    from rthm_analysis.diagnosis.numbers import percent

    words = (("nominal", "as specified"), ("retuned", "retuned"), ("explained", "explained"))
    known = [(nrmse[name], said) for name, said in words]
    changed = [known[0], *(now for before, now in pairwise(known) if now[0] != before[0])]
    errors = ", ".join(f"{percent(error, 3)} {said}" for error, said in changed)
    return f"{errors}; the noise alone is {percent(nrmse['noise_floor'], 3)}"
