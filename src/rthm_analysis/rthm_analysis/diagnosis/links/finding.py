"""What one link shows, as a `Part`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import BUSY_RATIO, LINK_FLOOR, LINK_TELLING_GAIN, USE_GRAIN
from rthm_analysis.diagnosis.links.ages import ages, expected
from rthm_analysis.diagnosis.links.energy import extra_energy
from rthm_analysis.diagnosis.links.evidence import LinkEvidence
from rthm_analysis.diagnosis.links.fitting import counted, deviation, fitted
from rthm_analysis.diagnosis.links.limits import smallest
from rthm_analysis.diagnosis.links.models import Model
from rthm_analysis.diagnosis.links.outages import faults_of
from rthm_analysis.diagnosis.links.selection import KINDS, Selection
from rthm_analysis.diagnosis.links.words import lateness, sentence
from rthm_analysis.diagnosis.result import Alternative, Fault, Fit, Limit, Mismatch, Part, Physics, Value
from rthm_analysis.recording import Recording
from rthm_core.clock import NS
from rthm_core.effects.registry import changing

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.effects.declaration import Change
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Finding:
    """What one link shows.

    Attributes
    ----------
    evidence, selection
        Of the whole recording, and of its first two thirds.
    busy : float
        Lateness of the machine as the other links show it, s.
    train_end, end : int
        End of the first two thirds and of the recording, ns after the start.
    """

    evidence: LinkEvidence
    selection: Selection
    busy: float
    train_end: int
    end: int

    @property
    def block(self) -> str:
        """Name of the block."""
        return f"link.{self.evidence.name}"

    @property
    def found(self) -> bool:
        """Whether anything but scheduling and outages was found."""
        return bool(self.selection.kinds) or self.evidence.offset_ns != 0

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Outages of the link."""
        return faults_of(self.evidence.name, self.evidence.due, self.evidence.outages)

    @property
    def nominal(self) -> Model:
        """Extra delays that the spec expects, relative to the stamps that the receiver read."""
        return Model(delay=-self.evidence.offset_ns / NS)


def link_part(recording: Recording, spec: Spec, finding: Finding) -> Part:
    """Diagnosis of one link."""
    limits = _limits(finding)
    faults = finding.faults
    blocks = (Mismatch(finding.block, mismatch(finding), finding.found or bool(faults)),)
    machine = finding.selection.nothing.late
    if not finding.found:
        notes = (lateness(finding.evidence.name, machine),) if machine > USE_GRAIN else ()
        return Part(blocks=blocks, detection_limits=limits, notes=notes, faults=faults)
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
    return Part(
        blocks=blocks,
        physics=physics,
        alternatives=_alternatives(finding, fit),
        fits=(fit,),
        detection_limits=limits,
        effects=effects,
        faults=faults,
    )


def _values(finding: Finding) -> dict[tuple[str, str], Value]:
    """Parameters of what was found, by kind and name."""
    values, model = {}, finding.selection.model
    if finding.evidence.offset_ns:
        offset = Value(finding.evidence.offset_ns / NS, finding.evidence.offset_std, "s")
        values[_kind_and_parameter("stamps")] = offset
    data = counted(finding.evidence.between(0, finding.train_end))
    for kind in finding.selection.kinds:
        std = deviation(data, model, kind)
        values[_kind_and_parameter(kind)] = Value(getattr(model, kind), std, _unit(kind))
    return values


def _kind_and_parameter(changes: Change) -> tuple[str, str]:
    """Kind of effect that changes something of a link, and its parameter."""
    law = changing("link", changes)
    return law.kind, next(iter(law.parameters))


def _unit(changes: Change) -> str:
    return changing("link", changes).unit(_kind_and_parameter(changes)[1], "link")


def _told(
    finding: Finding, values: dict[tuple[str, str], Value], share: float
) -> list[tuple[str, str, Value, str]]:
    return [
        (kind, parameter, value, sentence(finding.evidence.name, kind, value, share))
        for (kind, parameter), value in values.items()
    ]


def mismatch(finding: Finding) -> float:
    """Rms of the error in the age of the sample in use, over what clock and machine leave open."""
    evidence = finding.evidence
    seen = ages(evidence, 0, finding.end)
    if not seen.at.size:
        return 1.0
    left = seen.age - expected(evidence, finding.nominal, seen.at)[0]
    spread = expected(evidence, Model(share=0.999, mean=finding.busy), seen.at)[1] if finding.busy else 0.0
    floor = float(np.sqrt(LINK_FLOOR**2 + np.mean(np.square(spread))))
    return max(1.0, float(np.sqrt(np.mean(left**2))) / floor)


def _fit(finding: Finding) -> Fit:
    """Age of the sample in use on the last third, with models fitted before."""
    evidence = finding.evidence
    seen = ages(evidence, finding.train_end, finding.end)
    nominal = expected(evidence, finding.nominal, seen.at)[0]
    explained = expected(evidence, finding.selection.model, seen.at)[0]
    spread = expected(evidence, _as_held_out(finding), seen.at)[1]
    scale = max(float(np.std(seen.age)), USE_GRAIN)
    floor = np.sqrt(np.mean(spread**2) + USE_GRAIN**2) / scale
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
    kinds, model = finding.selection.kinds, finding.selection.model
    data = counted(finding.evidence.between(finding.train_end, finding.end))
    return fitted(data, kinds, model.share > 0.0, model) if kinds else model


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0


def _alternatives(finding: Finding, fit: Fit) -> tuple[Alternative, ...]:
    """Other explanations that were tried, and those that this recording cannot tell from the named one."""
    reached = fit.nrmse["explained"]
    others = []
    if finding.selection.kinds == ("delay",) and not finding.evidence.offset_ns:
        others.append(Alternative(finding.block, changing("link", "stamps").kind, reached, False))
        if finding.evidence.name == "tau4":
            others.append(Alternative("motor", changing("motor", "delay").kind, reached, False))
    for kinds, gain in finding.selection.gains.items():
        if len(kinds) == 1 and kinds[0] not in finding.selection.kinds:
            worse = fit.nrmse["nominal"] if gain < -LINK_TELLING_GAIN else reached
            kind = changing("link", kinds[0]).kind
            others.append(Alternative(finding.block, kind, worse, gain < -LINK_TELLING_GAIN))
    return tuple(others)


def _limits(finding: Finding) -> dict[str, Limit]:
    """Smallest effects that would have been seen."""
    allowance = BUSY_RATIO * finding.busy + USE_GRAIN
    nothing, limits = finding.selection.nothing, {}
    for changes in KINDS:
        value = smallest(finding.evidence, nothing, changes, allowance)
        limits[_key(finding, changes)] = Limit(value, _unit(changes))
    return limits | {_key(finding, "stamps"): Limit(USE_GRAIN, "s")}


def _key(finding: Finding, changes: Change) -> str:
    """Name of a detection limit."""
    return ".".join((finding.block, *_kind_and_parameter(changes)))
