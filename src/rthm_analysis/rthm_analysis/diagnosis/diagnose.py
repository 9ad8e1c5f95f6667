"""The whole diagnosis of a recording: links, computing blocks, physical side, in the loop's order."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.computed import diagnose_computed
from rthm_analysis.diagnosis.experiments import next_experiment
from rthm_analysis.diagnosis.links import diagnose_links
from rthm_analysis.diagnosis.names import check_names
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.replay.evidence import gather
from rthm_analysis.diagnosis.result import Diagnosis, Part, Verdict
from rthm_analysis.diagnosis.words import verdict_words
from rthm_analysis.recording import Recording
from rthm_core.errors import InputError
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec, apply, write_spec

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

FEWEST_SAMPLES = 200
SHORTEST = 0.5
"""Seconds; a shorter recording says nothing."""


def diagnose(recording: Recording, spec: Spec, progress: Callable[[str], None] | None = None) -> Diagnosis:
    """Find out where simulation and recording differ, which physics was left out, and how sure that is.

    Parameters
    ----------
    recording : Recording
        Of a hybrid test, or of a plant under known forces.
    spec : Spec
        The nominal model.
    progress : callable, optional
        Told what is being done, in words.

    Raises
    ------
    InputError
        When the spec has no plant, names or sizes of spec and recording do not fit, or the recording is too
        short to say anything.
    """
    say = progress or (lambda said: None)
    _check(recording, spec)
    parts: list[Part] = []
    if spec.timing is not None:
        say("checking the links")
        parts.append(diagnose_links(recording, spec))
        say("checking the computing blocks")
        parts.append(diagnose_computed(recording, _as_run(parts, spec)))
    here = _as_run(parts, spec)
    parts.append(
        physical_part(diagnose_physical(gather(recording, here), here, command_before(parts, spec), say))
    )
    say("putting it into words")
    return _joined(parts, spec)


def _check(recording: Recording, spec: Spec) -> None:
    if spec.plant is None:
        raise InputError(
            "plant is missing in the spec: nothing can be diagnosed without it; add a plant section."
        )
    check_names(recording, spec)
    samples = len(recording.plant)
    if samples < FEWEST_SAMPLES or recording.duration < SHORTEST:
        raise InputError(
            f"{recording.path} has {samples} samples over {recording.duration:.3g} s of plant/state, "
            f"but a diagnosis needs at least {FEWEST_SAMPLES} over {SHORTEST} s; record longer."
        )


def _as_run(parts: list[Part], spec: Spec) -> Spec:
    """Spec with the times and the compensator that the test was run with."""
    changes = {name: value for part in parts for name, value in part.changes.items()}
    return apply(spec, changes) if changes else spec


def _joined(parts: list[Part], spec: Spec) -> Diagnosis:
    physics = tuple(one for part in parts for one in part.physics)
    unexplained = tuple(said for part in parts for said in part.unexplained)
    retuned = {name: one for part in parts for name, one in part.retuned.items()}
    blocks = tuple(one for part in parts for one in part.blocks)
    named = [one.block for one in physics]
    located = tuple(dict.fromkeys([*named, *(b.block for b in blocks if b.significant)]))
    verdict: Verdict = (
        "unexplained" if unexplained else "explained" if physics else "retuned" if retuned else "match"
    )
    alternatives = tuple(one for part in parts for one in part.alternatives)
    unclear = [(a.block, a.kind) for a in alternatives if not a.distinguishable]
    return Diagnosis(
        verdict=verdict,
        blocks=blocks,
        located=located,
        physics=physics,
        retuned=retuned,
        alternatives=alternatives,
        fits=tuple(one for part in parts for one in part.fits),
        detection_limits={name: one for part in parts for name, one in part.detection_limits.items()},
        next_experiment=next_experiment(verdict, [(p.block, p.kind) for p in physics], unclear),
        words=verdict_words(verdict, located, physics, retuned),
        curves=tuple(one for part in parts for one in part.curves),
        unexplained=unexplained,
        notes=tuple(note for part in parts for note in part.notes),
        patched=write_spec(_patched(parts, spec)),
        faults=tuple(one for part in parts for one in part.faults),
        described=tuple(one for part in parts for one in part.described),
        traces=tuple(one for part in parts for one in part.traces),
        refused=tuple(one for part in parts for one in part.refused),
        free_run={dof: one for part in parts for dof, one in part.free_run.items()},
    )


def command_before(parts: list[Part], spec: Spec) -> Floats:
    """Command (m,) before the test, m, of a controller and a numerical side as they were found."""
    return first_command(_patched(parts, spec)) if spec.is_loop else np.empty(0)


def _patched(parts: list[Part], spec: Spec) -> Spec:
    """Spec whose simulation behaves as recorded."""
    changes: dict[str, object] = {name: value for part in parts for name, value in part.changes.items()}
    sections = [_flat(section) for part in parts for section in part.effects]
    if sections:
        taken = {e.name for e in spec.effects}
        names = [
            name for name in (f"found{i + 1}" for i in range(len(sections) + len(taken))) if name not in taken
        ]
        changes["effects"] = [*(e.name for e in spec.effects), *names[: len(sections)]]
        changes |= dict(zip(names, sections, strict=False))
    return apply(spec, changes) if changes else spec


def _flat(section: dict[str, object]) -> dict[str, object]:
    """Section with its parameters beside its block and kind, as in a spec."""
    inner = section.get("parameters")
    head = {key: value for key, value in section.items() if key != "parameters"}
    return head | inner if isinstance(inner, dict) else head
