"""The whole diagnosis of a recording: links, computing blocks, physical side, in the loop's order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.computed import diagnose_computed
from rthm_analysis.diagnosis.experiment.next_test import Found, Next, next_experiment
from rthm_analysis.diagnosis.experiment.rivals import rivals_of
from rthm_analysis.diagnosis.links import diagnose_links
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import gather
from rthm_analysis.diagnosis.result import Diagnosis, Part, Verdict
from rthm_analysis.diagnosis.words import stated_spreads, verdict_words
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
        When the spec has no plant, or the recording is too short to say anything.
    """
    say = progress or (lambda said: None)
    _check(recording, spec)
    parts = []
    if spec.timing is not None:
        say("checking the links")
        parts.append(diagnose_links(recording, spec))
        say("checking the computing blocks")
        parts.append(diagnose_computed(recording, spec))
    physical = diagnose_physical(gather(recording, spec), spec, command_before(parts, spec), say)
    parts.append(physical_part(physical))
    say("putting it into words")
    found = _joined(parts, spec)
    say("planning the next test")
    words, planned, gain = _next(found, physical, spec, _patched(parts, spec))
    return replace(found, next_experiment=words, next_experiment_spec=planned, next_experiment_gain=gain)


def _check(recording: Recording, spec: Spec) -> None:
    if spec.plant is None:
        raise InputError(
            "plant is missing in the spec: nothing can be diagnosed without it; add a plant section."
        )
    samples = len(recording.plant)
    if samples < FEWEST_SAMPLES or recording.duration < SHORTEST:
        raise InputError(
            f"{recording.path} has {samples} samples over {recording.duration:.3g} s of plant/state, "
            f"but a diagnosis needs at least {FEWEST_SAMPLES} over {SHORTEST} s; record longer."
        )
    missing = [dof for dof in spec.plant.dofs if dof not in recording.plant.names]
    if missing:
        raise InputError(
            f"the recording has {', '.join(recording.plant.names)}, but not {', '.join(missing)} of the "
            f"spec; use the spec of this test."
        )


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
    return Diagnosis(
        verdict=verdict,
        blocks=blocks,
        located=located,
        physics=physics,
        retuned=retuned,
        alternatives=tuple(one for part in parts for one in part.alternatives),
        fits=tuple(one for part in parts for one in part.fits),
        detection_limits={name: one for part in parts for name, one in part.detection_limits.items()},
        next_experiment="",
        words=verdict_words(verdict, located, physics, retuned, stated_spreads(spec)),
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


def _next(found: Diagnosis, physical: Physical, spec: Spec, patched: Spec) -> Next:
    """What to do next: noise, rivals and known forces are those of the physical side."""
    evidence = physical.evidence
    noise = {one.signal: float(size) for one, size in zip(evidence.channels, physical.sigma, strict=True)}
    forced = evidence.driven_by == "force" and np.any(evidence.load)
    return next_experiment(
        Found(
            spec,
            patched,
            found.verdict,
            found.physics,
            found.faults,
            found.retuned,
            found.detection_limits,
            rivals_of(physical, patched),
            noise,
            float(evidence.time[-1]),
            (evidence.time, evidence.load) if forced else None,
        )
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
