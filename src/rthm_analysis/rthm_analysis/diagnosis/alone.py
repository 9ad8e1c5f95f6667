"""What is found in a recording by itself, before several of one rig are looked at together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rthm_analysis.diagnosis.computed import diagnose_computed
from rthm_analysis.diagnosis.faults import Mended, mend, with_motion
from rthm_analysis.diagnosis.faults.bend import Bend
from rthm_analysis.diagnosis.faults.deviations import Deviation
from rthm_analysis.diagnosis.faults.drift import Drift
from rthm_analysis.diagnosis.faults.moments import Moment
from rthm_analysis.diagnosis.faults.other_loop import find_other_loop
from rthm_analysis.diagnosis.faults.sensor_gains import SensorGain
from rthm_analysis.diagnosis.faults.wander import Wander
from rthm_analysis.diagnosis.joining import as_run
from rthm_analysis.diagnosis.links import diagnose_links
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence, gather
from rthm_analysis.diagnosis.replay.updates import readings_only
from rthm_analysis.diagnosis.result import Fault, Mismatch, Part
from rthm_analysis.recording import Recording

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class WrongSpecError(Exception):
    """The spec is not that of a recording."""

    def __init__(self, faults: Sequence[Fault], notes: Sequence[str] = ()) -> None:
        super().__init__()
        self.faults, self.notes = tuple(faults), tuple(notes)


@dataclass(frozen=True)
class Alone:
    """A recording with what was found in it by itself.

    Attributes
    ----------
    recording : Recording
    spec : Spec
        The nominal model.
    parts : tuple of Part
        Links and computing blocks.
    mended : Mended
    """

    recording: Recording
    spec: Spec
    parts: tuple[Part, ...]
    mended: Mended

    @property
    def evidence(self) -> Evidence:
        """Of the physical side, as it should have been recorded."""
        return readings_only(self.mended.evidence).under_command()

    def moved_back(self, late: Mapping[Channel, float]) -> Alone:
        """The same with channels that come late by so many seconds."""
        return replace(self, mended=self.mended.moved_back(late)).judged_by_motion()

    def without(self, deviation: Drift | Deviation | Wander) -> Alone:
        """The same without what the whole recording deviates by."""
        return replace(self, mended=self.mended.without(deviation))

    def with_gains(self, gains: Sequence[SensorGain]) -> Alone:
        """The same with the true values of sensors that read too much or too little."""
        evidence = self.mended.evidence
        for one in gains:
            evidence = one.corrected(evidence)
        return replace(self, mended=replace(self.mended, evidence=evidence))

    def without_moments(self, moments: Sequence[Moment]) -> Alone:
        """The same without the moments in which something pushed the plant, or its sensors were off."""
        return replace(self, mended=self.mended.without_moments(moments))

    def straightened(self, bends: Mapping[Channel, Bend]) -> Alone:
        """The same without the errors of sensors that are not linear."""
        return replace(self, mended=self.mended.straightened(bends)).judged_by_motion()

    def judged_by_motion(self) -> Alone:
        """The same with the computing blocks judged by the motion as it should have been recorded, if that is
        closer to what they computed: they may have been given what was recorded.
        """
        if not (self.mended.moved and self.spec.is_loop):
            return self
        links, computed = self.parts
        motion = with_motion(self.recording, self.mended.evidence)
        again = diagnose_computed(motion, as_run([links], self.spec))
        return replace(self, parts=(links, min(again, computed, key=_mismatch)))


def look_alone(recording: Recording, spec: Spec, say: Callable[[str], None]) -> Alone:
    """Find what is wrong with links, computing blocks and the recording itself.

    Raises
    ------
    WrongSpecError
        When hardly anything in it agrees with the spec.
    """
    parts: list[Part] = []
    if spec.timing is not None:
        say("checking the links")
        parts.append(diagnose_links(recording, spec))
        say("checking the computing blocks")
        parts.append(diagnose_computed(recording, as_run(parts, spec)))
        if other := find_other_loop(parts):
            raise WrongSpecError(other)
    here = as_run(parts, spec)
    say("checking the recording itself")
    mended = mend(gather(recording, here), here)
    if any(fault.kind == "wrong_spec" for fault in mended.faults):
        raise WrongSpecError(mended.faults, mended.notes)
    return Alone(recording, spec, tuple(parts), mended).judged_by_motion()


def _mismatch(part: Part) -> float:
    return max((one.mismatch for one in part.blocks), default=0.0)


def software_part(several: Sequence[Alone]) -> Part:
    """What links, computing blocks and the recordings themselves show.

    Of several recordings a block is as bad as in the worst, an effect is told as in the first that shows it,
    and what is wrong with a recording is told with its name.
    """
    if len(several) == 1:
        mended = several[0].mended
        return Part.joined([*several[0].parts, Part(faults=mended.faults, notes=mended.notes)])
    wholes = [Part.joined(one.parts) for one in several]
    last_first = wholes[::-1]  # the first recording overrides
    shared = replace(
        wholes[0],
        blocks=_worst(wholes),
        physics=_of_names({(p.block, p.kind): p for one in last_first for p in one.physics}),
        effects=_of_names({(e["block"], e["kind"]): e for one in last_first for e in one.effects}),
        faults=_of_names({(f.block, f.kind, f.channel): f for one in last_first for f in one.faults}),
        retuned={name: value for one in last_first for name, value in one.retuned.items()},
        changes={name: value for one in last_first for name, value in one.changes.items()},
        unexplained=tuple(dict.fromkeys(words for one in wholes for words in one.unexplained)),
    )
    return Part.joined([shared, *(_with_name(one) for one in several)])


def _worst(wholes: Sequence[Part]) -> tuple[Mismatch, ...]:
    """Each block with its largest mismatch."""
    found: dict[str, Mismatch] = {}
    for one in (block for whole in wholes for block in whole.blocks):
        before = found.get(one.block, one)
        found[one.block] = max(before, one, key=lambda block: (block.significant, block.mismatch))
    return tuple(found.values())


def _of_names(found: dict[Any, Any]) -> tuple[Any, ...]:
    return tuple(found.values())


def _with_name(one: Alone) -> Part:
    """What is wrong with a recording itself, told with its name."""
    name, mended = one.recording.name, one.mended
    faults = tuple(replace(fault, words=f"In {name}: {fault.words}") for fault in mended.faults)
    return Part(faults=faults, notes=tuple(f"{name}: {note}" for note in mended.notes))
