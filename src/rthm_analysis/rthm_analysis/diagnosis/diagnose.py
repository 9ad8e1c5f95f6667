"""The whole diagnosis of a recording: links, computing blocks, physical side, in the loop's order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.alone import Alone, WrongSpecError, look_alone, software_part
from rthm_analysis.diagnosis.criteria.readings import PUSH_SEARCHES
from rthm_analysis.diagnosis.criteria.verdict import FEWEST_RECORDED_SAMPLES
from rthm_analysis.diagnosis.experiment.next_test import Found, Next, next_experiment
from rthm_analysis.diagnosis.experiment.rivals import rivals_of
from rthm_analysis.diagnosis.faults.sensor_gains import find_gains
from rthm_analysis.diagnosis.joining import as_run, joined, patched_spec
from rthm_analysis.diagnosis.names import check_names, check_one_rig
from rthm_analysis.diagnosis.physical.bent_sensors import bent_sensors, straight_or_curved
from rthm_analysis.diagnosis.physical.deviating import deviation
from rthm_analysis.diagnosis.physical.drifting_clocks import drifting_clocks
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.gains_told import gains_told
from rthm_analysis.diagnosis.physical.late_sensors import late_sensors, undecided
from rthm_analysis.diagnosis.physical.own_zeros import diagnose_several
from rthm_analysis.diagnosis.physical.pushed import pushed
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.wandering import wandering
from rthm_analysis.diagnosis.replay.joint import one_after_the_other
from rthm_analysis.diagnosis.result import Described, Diagnosis, Fault, Part
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
    return diagnose_together([recording], [spec], progress)


def diagnose_together(
    recordings: Sequence[Recording], specs: Sequence[Spec], progress: Callable[[str], None] | None = None
) -> Diagnosis:
    """Find one explanation for several recordings of a rig: other levels, other inputs, other days.

    What is missing has the same values in all; each recording begins in a state of its own, and may have
    sensors with a zero of its own. The last one
    confirms what the others show, and has no part in any choice or fit.

    Parameters
    ----------
    recordings : sequence of Recording
        At least one; one by itself is diagnosed as by `diagnose`.
    specs : sequence of Spec
        The nominal model of each: they may differ in loads and timing. The first is patched.
    progress : callable, optional
        Told what is being done, in words.

    Raises
    ------
    InputError
        As `diagnose`; also when the recordings or their specs are not of one rig.

    Examples
    --------
    >>> low, high = (read_recording(path) for path in ("low/bag", "high/bag"))  # doctest: +SKIP
    >>> diagnose_together([low, high], [spec, spec]).physics[0].kind  # doctest: +SKIP
    'cubic_stiffness'
    """
    say, spec = progress or (lambda said: None), specs[0]
    for one, nominal in zip(recordings, specs, strict=True):
        _check(one, nominal)
    check_one_rig(specs, [one.name for one in recordings])
    try:
        several = [look_alone(*one, say) for one in zip(recordings, specs, strict=True)]
    except WrongSpecError as wrong:
        return _stopped(spec, wrong.faults, wrong.notes)
    gains = find_gains(several[0].evidence, as_run(several[0].parts, spec)) if len(several) == 1 else []
    several = _steady([one.with_gains(gains) for one in several], say)
    physical = _physical(several, say)
    pushes: list[Described] = []
    for _ in range(PUSH_SEARCHES):
        if not (moments := pushed(physical)):
            break
        pushes += [one.push for one in moments if one.push is not None]
        several = [one.without_moments(moments) for one in several]
        physical = _physical(several, say)
    lateness = late_sensors(physical)
    if late := {one.channel: one.delay for one in lateness if one.is_clear}:
        several = [one.moved_back(late) for one in several]
        physical = _physical(several, say)
    if (off := drifting_clocks(physical) or deviation(physical)) is not None:
        several = [one.without(off) for one in several]
        physical = _physical(several, say)
    bent = bent_sensors(physical)
    if bends := {one.channel: one.bend for one in bent if one.is_clear}:
        several = [one.straightened(bends) for one in several]
        physical = _physical(several, say)
    notes = (*undecided(lateness), *straight_or_curved(bent))
    parts = [software_part(several), Part(notes=notes), gains_told(gains), physical_part(physical, pushes)]
    say("putting it into words")
    found = joined(parts, spec)
    say("planning the next test")
    words, planned, gain = _next(found, physical, spec, patched_spec(parts, spec))
    return replace(found, next_experiment=words, next_experiment_spec=planned, next_experiment_gain=gain)


def _steady(several: Sequence[Alone], say: Callable[[str], None]) -> list[Alone]:
    """The same without the error of a sensor whose zero wanders, where there is one recording."""
    if len(several) > 1:
        return list(several)
    (one,) = several
    wander = wandering(one.evidence, as_run(one.parts, one.spec), say)
    return [one if wander is None else one.without(wander)]


def _physical(several: Sequence[Alone], say: Callable[[str], None]) -> Physical:
    parts, spec = several[0].parts, several[0].spec
    before = command_before(parts, spec)
    names = [one.recording.name for one in several]
    evidence = one_after_the_other([one.evidence for one in several], names, before).until_rest()
    return diagnose_several(evidence, as_run(parts, spec), before, say)


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
    first, (begin, end) = evidence.recordings[0], evidence.spans[0]
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
            end - begin,
            (evidence.time[first], evidence.load[first]) if forced else None,
        )
    )


def command_before(parts: Sequence[Part], spec: Spec) -> Floats:
    """Command (m,) before the test, m, of a controller and a numerical side as they were found."""
    return first_command(patched_spec(parts, spec)) if spec.is_loop else np.empty(0)
