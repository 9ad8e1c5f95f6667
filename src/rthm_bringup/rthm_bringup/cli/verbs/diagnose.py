"""``rthm diagnose``: why a recording differs from its simulation."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.options import Bag, Json, spec_named

if TYPE_CHECKING:
    from rthm_analysis.diagnosis import Diagnosis


def verb(
    bag: Bag,
    spec: Annotated[
        str | None, typer.Option("--spec", metavar="SPEC", help="Nominal model; the bag's own by default.")
    ] = None,
    report: Annotated[
        Path | None, typer.Option("--report", metavar="FILE.html", help="Write a page about it.")
    ] = None,
    patched: Annotated[
        Path | None, typer.Option("--patched", metavar="SPEC", help="Write a spec that behaves as recorded.")
    ] = None,
    json: Json = None,
) -> int:
    """Say where a recording and its simulation differ, and which physics was left out."""
    from rthm_analysis.diagnosis import diagnose
    from rthm_analysis.recording import read_recording
    from rthm_bringup.cli.output import put, status

    recording = read_recording(bag)
    nominal = spec_named(spec) if spec else recording.known_spec()
    with status("reading") as say:
        found = diagnose(recording, nominal, say)
    if patched:
        patched.write_text(found.patched, encoding="utf-8")
    if report:
        from rthm_analysis.report.diagnosis import write_diagnosis

        write_diagnosis(found, recording, nominal, report)
    put(found.as_dict(), _lines(found), json)
    return 1 if found.verdict == "unexplained" else 0


def _lines(found: Diagnosis) -> Iterator[str]:
    """The answer, how much better it is, what else it could be, what to try next."""
    yield f"{found.verdict}: {found.words}"
    yield from found.unexplained
    for fit in found.fits:
        errors = fit.nrmse
        span = "" if fit.window is None else f" in free runs of {fit.window:.3g} s"
        yield (
            f"{fit.signal} on data that no fit has seen ({fit.held_out[0]:.4g} to {fit.held_out[1]:.4g} s)"
            f"{span}: error {errors['nominal']:.4g} of its standard deviation as specified, "
            f"{errors['retuned']:.4g} retuned, {errors['explained']:.4g} explained; "
            f"noise {errors['noise_floor']:.4g}"
        )
    unclear = [f"{a.kind} ({a.block})" for a in found.alternatives if not a.distinguishable]
    if unclear:
        yield f"this recording cannot tell it from: {', '.join(dict.fromkeys(unclear))}"
    yield f"next: {found.next_experiment}"
    yield from found.notes
