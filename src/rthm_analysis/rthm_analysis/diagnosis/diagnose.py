"""The whole diagnosis of a recording: links, computing blocks, physical side, in the loop's order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.computed import diagnose_computed
from rthm_analysis.diagnosis.criteria.verdict import FEWEST_RECORDED_SAMPLES
from rthm_analysis.diagnosis.experiment.next_test import Found, Next, next_experiment
from rthm_analysis.diagnosis.experiment.rivals import rivals_of
from rthm_analysis.diagnosis.faults import Mended, mend, with_motion
from rthm_analysis.diagnosis.faults.other_loop import find_other_loop
from rthm_analysis.diagnosis.joining import as_run, joined, patched_spec
from rthm_analysis.diagnosis.links import diagnose_links
from rthm_analysis.diagnosis.names import check_names
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.late_sensors import late_sensors, undecided
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import gather
from rthm_analysis.diagnosis.replay.updates import readings_only
from rthm_analysis.diagnosis.result import Diagnosis, Fault, Part
from rthm_analysis.recording import Recording
from rthm_core.errors import InputError
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


STOPPED = "Nothing else was looked for."


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
        parts.append(diagnose_computed(recording, as_run(parts, spec)))
        if other := find_other_loop(parts):
            return _stopped(spec, other)
    here = as_run(parts, spec)
    say("checking the recording itself")
    mended = mend(gather(recording, here), here)
    if any(fault.kind == "wrong_spec" for fault in mended.faults):
        return _stopped(spec, mended.faults, mended.notes)
    parts = _with_motion(parts, recording, mended, spec)
    physical = _physical(parts, mended, spec, say)
    lateness = late_sensors(physical)
    if late := {one.channel: one.delay for one in lateness if one.is_clear}:
        mended = mended.moved_back(late)
        parts = _with_motion(parts, recording, mended, spec)
        physical = _physical(parts, mended, spec, say)
    notes = (*mended.notes, *undecided(lateness))
    parts += [Part(faults=mended.faults, notes=notes), physical_part(physical)]
    say("putting it into words")
    found = joined(parts, spec)
    say("planning the next test")
    words, planned, gain = _next(found, physical, spec, patched_spec(parts, spec))
    return replace(found, next_experiment=words, next_experiment_spec=planned, next_experiment_gain=gain)


def _with_motion(parts: list[Part], recording: Recording, mended: Mended, spec: Spec) -> list[Part]:
    """Parts with the computing blocks judged by the motion as it should have been recorded, if that is
    closer to what they computed: they may have been given what was recorded.
    """
    if not (mended.moved and spec.is_loop):
        return parts
    again = diagnose_computed(with_motion(recording, mended.evidence), as_run(parts[:-1], spec))
    return [*parts[:-1], min(again, parts[-1], key=_mismatch)]


def _mismatch(part: Part) -> float:
    return max((one.mismatch for one in part.blocks), default=0.0)


def _physical(parts: list[Part], mended: Mended, spec: Spec, say: Callable[[str], None]) -> Physical:
    evidence = readings_only(mended.evidence).under_command()
    return diagnose_physical(evidence, as_run(parts, spec), command_before(parts, spec), say)


def _check(recording: Recording, spec: Spec) -> None:
    if spec.plant is None:
        raise InputError(
            "plant is missing in the spec: nothing can be diagnosed without it; add a plant section."
        )
    check_names(recording, spec)
    samples = len(recording.plant)
    if samples < FEWEST_RECORDED_SAMPLES:
        raise InputError(
            f"{recording.path} has {samples} samples of plant/state, but a diagnosis needs at least "
            f"{FEWEST_RECORDED_SAMPLES}; record longer, or sample faster."
        )


def _stopped(spec: Spec, faults: Sequence[Fault], notes: Sequence[str] = ()) -> Diagnosis:
    """Answer for a spec that is not that of this test: everything else would be about two different rigs."""
    only = Part(faults=tuple(faults), notes=tuple(notes), unexplained=(STOPPED,))
    return replace(joined([only], spec), next_experiment="Diagnose again with the spec of this test.")


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
    return first_command(patched_spec(parts, spec)) if spec.is_loop else np.empty(0)
