"""The diagnosis of all links."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.diagnosis.criteria.links import BUSY_RATIO, PUNCTUAL_LATE_SHARE, USE_GRAIN
from rthm_analysis.diagnosis.links.evidence import LinkEvidence, link_evidence
from rthm_analysis.diagnosis.links.finding import Finding, link_part, mismatch
from rthm_analysis.diagnosis.links.models import Model
from rthm_analysis.diagnosis.links.selection import Selection, choose, is_exact
from rthm_analysis.diagnosis.links.times import wrong_times
from rthm_analysis.diagnosis.links.words import stall_words
from rthm_analysis.diagnosis.result import Mismatch, Part
from rthm_analysis.recording import Recording
from rthm_analysis.timing.host_stalls import host_stalls, stall_statistics
from rthm_core.clock import to_ns
from rthm_core.schedule import Schedule
from rthm_core.spec import apply
from rthm_core.topics import LINKS

if TYPE_CHECKING:
    from rthm_core.compiled import Integers
    from rthm_core.spec import Spec


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
    spans = host_stalls(recording)
    times = wrong_times(recording, spec, spans)
    if not times.faults:
        return _diagnosed(recording, spec, spans)
    found = _diagnosed(recording, apply(spec, times.changes), spans)
    blocks = tuple(_with_wrong_delay(recording, spec, spans, one, times.changes) for one in found.blocks)
    return replace(found, blocks=blocks, faults=(*times.faults, *found.faults), changes=times.changes)


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
    exact = Selection((), Model(), Model(), {})
    return Mismatch(block.block, mismatch(Finding(evidence, exact, 0.0, 2 * end // 3, end)), True)


def _diagnosed(recording: Recording, spec: Spec, spans: Integers) -> Part:
    """Diagnosis of all links with the times of the test."""
    end = to_ns(recording.duration) + 1
    train_end = 2 * end // 3
    schedule = Schedule(spec)
    known = [link_evidence(recording, spec, schedule, name, spans) for name in LINKS]
    notes = (
        *stall_words(stall_statistics(spans, recording.duration)),
        *(clock.words(node) for node, clock in recording.clocks.nodes.items()),
        *(one for one in known if isinstance(one, str)),
    )
    evidences = [one for one in known if isinstance(one, LinkEvidence)]
    choices = _choices(recording, [one.between(0, train_end) for one in evidences])
    lates = [one.nothing.late for one in choices]
    parts = []
    for i, (evidence, selection) in enumerate(zip(evidences, choices, strict=True)):
        others = lates[:i] + lates[i + 1 :]
        busy = float(np.median(others)) if others else 0.0
        busy += recording.clocks.uncertainty(evidence.name) * recording.clocks.applied
        finding = Finding(evidence, _beyond_machine(selection, busy), busy, train_end, end)
        parts.append(link_part(recording, spec, finding))
    return Part.joined([Part(notes=notes), *parts])


def _choices(recording: Recording, evidences: list[LinkEvidence]) -> list[Selection]:
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
    return bool(passed_over < PUNCTUAL_LATE_SHARE or any(count != "0" for count in counts))


def _beyond_machine(selection: Selection, busy: float) -> Selection:
    """Take kinds out that are no more than what the machine does to the other links."""
    least = {"delay": BUSY_RATIO * busy + USE_GRAIN, "spread": BUSY_RATIO * busy + USE_GRAIN, "lost": 0.0}
    kept = tuple(kind for kind in selection.kinds if abs(getattr(selection.model, kind)) > least[kind])
    if kept == selection.kinds:
        return selection
    left = {kind: 0.0 for kind in selection.kinds if kind not in kept}
    return Selection(kept, selection.model.but(**left) if kept else selection.nothing, selection.nothing, {})
