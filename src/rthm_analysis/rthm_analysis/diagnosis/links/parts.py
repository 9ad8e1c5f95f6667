"""The diagnosis of all links."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.diagnosis.links.ages import ages, expected
from rthm_analysis.diagnosis.links.choice import DISTINCT, Choice, choose, is_exact
from rthm_analysis.diagnosis.links.energy import extra_energy
from rthm_analysis.diagnosis.links.evidence import GRAIN, LinkEvidence, link_evidence
from rthm_analysis.diagnosis.links.fitting import counted, deviation, fitted
from rthm_analysis.diagnosis.links.limits import smallest
from rthm_analysis.diagnosis.links.models import Model
from rthm_analysis.diagnosis.links.times import wrong_times
from rthm_analysis.diagnosis.links.words import lateness, sentence, stood_still
from rthm_analysis.diagnosis.result import Alternative, Fit, Limit, Mismatch, Part, Physics, Value
from rthm_analysis.recording import LINKS, Recording
from rthm_analysis.timing.standing import held_up, standing
from rthm_core.clock import NS, to_ns
from rthm_core.schedule import Schedule
from rthm_core.spec import apply

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec

KINDS = {"delay": ("extra_delay", "delay"), "jitter": ("jitter", "std"), "loss": ("loss", "fraction")}
"""Kind and parameter in the spec of what a model calls delay, jitter and loss."""

FLOOR = 1e-5
"""Error in the age of a sample that clocks and rounding leave, s."""

RARE = 0.01
"""Share of the ticks up to which a punctual machine may be late."""

BUSY = 3.0
"""A delay or jitter must be so many times what the machine does to the other links."""


@dataclass(frozen=True)
class Finding:
    """What one link shows.

    Attributes
    ----------
    evidence, choice
        Of the whole recording, and of its first two thirds.
    busy : float
        Lateness of the machine as the other links show it, s.
    train_end, end : int
        End of the first two thirds and of the recording, ns after the start.
    """

    evidence: LinkEvidence
    choice: Choice
    busy: float
    train_end: int
    end: int

    @property
    def block(self) -> str:
        """Name of the block."""
        return f"link.{self.evidence.name}"

    @property
    def found(self) -> bool:
        """Whether anything but scheduling was found."""
        return bool(self.choice.kinds) or self.evidence.offset_ns != 0

    @property
    def nominal(self) -> Model:
        """Extra delays that the spec expects, relative to the stamps that the receiver read."""
        return Model(delay=-self.evidence.offset_ns / NS)


def diagnose_links(recording: Recording, spec: Spec) -> Part:
    """Find delays, jitter, losses and clock offsets that the spec does not know.

    Parameters
    ----------
    recording : Recording
    spec : Spec
        What the test was to be; of a plant alone nothing is said.

    Returns
    -------
    Part
        Blocks ``link.tau1`` to ``link.tau4``; as `faults` the times of the spec that are not those of the
        test, which are in `changes`.
    """
    if not spec.is_loop:
        return Part()
    spans = standing(recording)
    times = wrong_times(recording, spec, spans)
    if not times.faults:
        return _diagnosed(recording, spec, spans)
    found = _diagnosed(recording, apply(spec, times.changes), spans)
    blocks = tuple(_with_wrong_delay(recording, spec, spans, one, times.changes) for one in found.blocks)
    return replace(found, blocks=blocks, faults=times.faults, changes=times.changes)


def _with_wrong_delay(
    recording: Recording, spec: Spec, spans: Integers, block: Mismatch, changes: dict[str, Any]
) -> Mismatch:
    """Mismatch of a link whose delay in the spec is not that of the test."""
    name = block.block.removeprefix("link.")
    clocks = {key: value for key, value in changes.items() if not key.startswith("timing.tau")}
    here = apply(spec, clocks)
    evidence = link_evidence(recording, here, Schedule(here), name, spans)
    if f"timing.{name}" not in changes or isinstance(evidence, str):
        return block
    end = to_ns(recording.duration) + 1
    exact = Choice((), Model(), Model(), {})
    return Mismatch(block.block, _mismatch(Finding(evidence, exact, 0.0, 2 * end // 3, end)), True)


def _diagnosed(recording: Recording, spec: Spec, spans: Integers) -> Part:
    """Diagnosis of all links with the times of the test."""
    end = to_ns(recording.duration) + 1
    train_end = 2 * end // 3
    schedule = Schedule(spec)
    known = [link_evidence(recording, spec, schedule, name, spans) for name in LINKS]
    notes = (
        *stood_still(held_up(spans, recording.duration)),
        *(one for one in known if isinstance(one, str)),
    )
    evidences = [one for one in known if isinstance(one, LinkEvidence)]
    choices = _choices(recording, [one.between(0, train_end) for one in evidences])
    lates = [one.nothing.late for one in choices]
    parts = []
    for i, (evidence, choice) in enumerate(zip(evidences, choices, strict=True)):
        others = lates[:i] + lates[i + 1 :]
        busy = float(np.median(others)) if others else 0.0
        finding = Finding(evidence, _beyond_machine(choice, busy), busy, train_end, end)
        parts.append(_part(recording, spec, finding))
    return _joined(parts, notes)


def _choices(recording: Recording, evidences: list[LinkEvidence]) -> list[Choice]:
    """Choose for each link.

    Whether a sample that was passed over at a tick was late or lost is not always told by the uses. When all
    other links are punctual and no node tells that samples came late, the machine is not the reason.
    """
    exact = [is_exact(one) for one in evidences]
    choices = []
    for i, evidence in enumerate(evidences):
        others = exact[:i] + exact[i + 1 :]
        punctual = (
            evidence.clocked and len(others) > 1 and all(others) and not _told_late(recording, evidence)
        )
        choices.append(choose(evidence, machine=not punctual))
    return choices


def _told_late(recording: Recording, evidence: LinkEvidence) -> bool:
    """Whether it is more than strays that came late, or whether a receiver says that samples did."""
    passed_over = np.count_nonzero(evidence.low >= 0.0) / max(evidence.use_ns.size, 1)
    counts = [values.get(f"{evidence.name} late", "0") for values in recording.diagnostics.values()]
    return bool(passed_over < RARE or any(count != "0" for count in counts))


def _beyond_machine(choice: Choice, busy: float) -> Choice:
    """Take kinds out that are no more than what the machine does to the other links."""
    least = {"delay": BUSY * busy + GRAIN, "jitter": BUSY * busy + GRAIN, "loss": 0.0}
    kept = tuple(kind for kind in choice.kinds if abs(getattr(choice.model, kind)) > least[kind])
    if kept == choice.kinds:
        return choice
    left = {kind: 0.0 for kind in choice.kinds if kind not in kept}
    return Choice(kept, choice.model.but(**left) if kept else choice.nothing, choice.nothing, {})


def _joined(parts: list[Part], notes: tuple[str, ...]) -> Part:
    return Part(
        blocks=tuple(one for part in parts for one in part.blocks),
        physics=tuple(one for part in parts for one in part.physics),
        alternatives=tuple(one for part in parts for one in part.alternatives),
        fits=tuple(one for part in parts for one in part.fits),
        detection_limits={name: limit for part in parts for name, limit in part.detection_limits.items()},
        effects=tuple(one for part in parts for one in part.effects),
        notes=(*notes, *(note for part in parts for note in part.notes)),
    )


def _part(recording: Recording, spec: Spec, finding: Finding) -> Part:
    """Diagnosis of one link."""
    limits = _limits(finding)
    blocks = (Mismatch(finding.block, _mismatch(finding), finding.found),)
    machine = finding.choice.nothing.late
    if not finding.found:
        notes = (lateness(finding.evidence.name, machine),) if machine > GRAIN else ()
        return Part(blocks=blocks, detection_limits=limits, notes=notes)
    fit = _fit(finding)
    share = 1.0 - (fit.nrmse["explained"] / max(fit.nrmse["nominal"], 1e-12)) ** 2
    late = 0.0 if fit.explained is None or fit.nominal is None else np.mean(fit.explained - fit.nominal)
    energy = extra_energy(recording, spec, finding.evidence.name, float(late))
    values = _values(finding)
    physics = tuple(
        Physics(finding.block, kind, None, {parameter: value}, words, energy / len(values), share)
        for kind, parameter, value, words in _told(finding, values, share)
    )
    effects = tuple(
        {"block": finding.block, "kind": kind, "parameters": {parameter: value.value}}
        for (kind, parameter), value in values.items()
    )
    return Part(blocks, physics, {}, _alternatives(finding, fit), (fit,), limits, (), {}, effects)


def _values(finding: Finding) -> dict[tuple[str, str], Value]:
    """Parameters of what was found, by kind and name."""
    values, model = {}, finding.choice.model
    if finding.evidence.offset_ns:
        values["clock_offset", "offset"] = Value(finding.evidence.offset_ns / NS, GRAIN, "s")
    data = counted(finding.evidence.between(0, finding.train_end))
    for kind in finding.choice.kinds:
        std = deviation(data, model, kind)
        values[KINDS[kind]] = Value(getattr(model, kind), std, "1" if kind == "loss" else "s")
    return values


def _told(
    finding: Finding, values: dict[tuple[str, str], Value], share: float
) -> list[tuple[str, str, Value, str]]:
    return [
        (kind, parameter, value, sentence(finding.evidence.name, kind, value, share))
        for (kind, parameter), value in values.items()
    ]


def _mismatch(finding: Finding) -> float:
    """Rms of the error in the age of the sample in use, over what clock and machine leave open."""
    evidence = finding.evidence
    seen = ages(evidence, 0, finding.end)
    if not seen.at.size:
        return 1.0
    left = seen.age - expected(evidence, finding.nominal, seen.at)[0]
    spread = expected(evidence, Model(share=0.999, mean=finding.busy), seen.at)[1] if finding.busy else 0.0
    floor = float(np.sqrt(FLOOR**2 + np.mean(np.square(spread))))
    return max(1.0, float(np.sqrt(np.mean(left**2))) / floor)


def _fit(finding: Finding) -> Fit:
    """Age of the sample in use on the last third, with models fitted before."""
    evidence = finding.evidence
    seen = ages(evidence, finding.train_end, finding.end)
    nominal = expected(evidence, finding.nominal, seen.at)[0]
    explained = expected(evidence, finding.choice.model, seen.at)[0]
    spread = expected(evidence, _as_held_out(finding), seen.at)[1]
    scale = max(float(np.std(seen.age)), GRAIN)
    floor = np.sqrt(np.mean(spread**2) + GRAIN**2) / scale
    nrmse = {
        "nominal": _rms(seen.age - nominal) / scale,
        "retuned": _rms(seen.age - nominal) / scale,
        "explained": _rms(seen.age - explained) / scale,
        "noise_floor": float(floor),
    }
    spans = (0.0, finding.train_end / NS), (finding.train_end / NS, finding.end / NS)
    return Fit(finding.block, "age", None, *spans, nrmse, seen.at / NS, seen.age, nominal, nominal, explained)


def _as_held_out(finding: Finding) -> Model:
    """The named kinds as large as the last third itself has them: what nobody could predict better."""
    kinds, model = finding.choice.kinds, finding.choice.model
    data = counted(finding.evidence.between(finding.train_end, finding.end))
    return fitted(data, kinds, model.share > 0.0, model) if kinds else model


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0


def _alternatives(finding: Finding, fit: Fit) -> tuple[Alternative, ...]:
    """Other explanations that were tried, and those that this recording cannot tell from the named one."""
    reached = fit.nrmse["explained"]
    others = []
    if finding.choice.kinds == ("delay",) and not finding.evidence.offset_ns:
        others.append(Alternative(finding.block, "clock_offset", reached, False))
        if finding.evidence.name == "tau4":
            others.append(Alternative("motor", "extra_delay", reached, False))
    for kinds, gain in finding.choice.gains.items():
        if len(kinds) == 1 and kinds[0] not in finding.choice.kinds:
            worse = fit.nrmse["nominal"] if gain < -DISTINCT else reached
            others.append(Alternative(finding.block, KINDS[kinds[0]][0], worse, gain < -DISTINCT))
    return tuple(others)


def _limits(finding: Finding) -> dict[str, Limit]:
    """Smallest effects that would have been seen."""
    allowance = BUSY * finding.busy + GRAIN
    nothing, limits = finding.choice.nothing, {}
    for name, (kind, parameter) in KINDS.items():
        value = smallest(finding.evidence, nothing, name, allowance)
        limits[f"{finding.block}.{kind}.{parameter}"] = Limit(value, "1" if name == "loss" else "s")
    return limits | {f"{finding.block}.clock_offset.offset": Limit(GRAIN, "s")}
