"""What the parts of a diagnosis say together: the verdict, and the spec that behaves as recorded."""

from __future__ import annotations

from collections.abc import Sequence

from rthm_analysis.diagnosis.criteria.verdict import PATCHED_ERROR_RATIO, RUNAWAY_ERROR_RATIO
from rthm_analysis.diagnosis.replay.entries import OF_PLANT, entry_of
from rthm_analysis.diagnosis.result import Diagnosis, Part, Verdict
from rthm_analysis.diagnosis.words import stated_spreads, verdict_words
from rthm_core.spec import Spec, apply, write_spec


def joined(parts: Sequence[Part], spec: Spec) -> Diagnosis:
    """The parts as one answer; what to do next is left open."""
    whole = Part.joined(parts)
    significant = [one.block for one in whole.blocks if one.significant]
    verdict = _verdict(whole)
    where = [*(one.block for one in whole.faults if not one.marked), *(one.block for one in whole.physics)]
    located = tuple(dict.fromkeys([*where, *significant]))
    runs = verdict != "unexplained" and _runs(whole)
    found = {name: one for name, one in vars(whole).items() if name not in ("changes", "effects")}
    return Diagnosis(
        **found,
        verdict=verdict,
        located=located,
        next_experiment="",
        words=verdict_words(
            verdict,
            located,
            whole.physics,
            whole.retuned,
            stated_spreads(spec),
            whole.faults,
            whole.described,
            whole.traces,
        ),
        patched=write_spec(patched_spec(parts, spec)) if runs else "",
    )


def _verdict(whole: Part) -> Verdict:
    """Contract, section 7: what is left lowers everything; what is wrong with the recording explains."""
    if whole.unexplained:
        confirmed = any(one.held_out_gain > 0.0 for one in whole.described)
        return "improved" if whole.physics or confirmed else "unexplained"
    if whole.physics or whole.described or any(not one.marked for one in whole.faults):
        return "explained"
    return "retuned" if whole.retuned else "match"


def _runs(whole: Part) -> bool:
    """Whether a free run of the patched spec stays bounded and is no worse than that of the nominal one."""
    return all(
        run.explained < min(RUNAWAY_ERROR_RATIO, PATCHED_ERROR_RATIO * run.nominal + 1e-9)
        for run in whole.free_run.values()
    )


def as_run(parts: Sequence[Part], spec: Spec) -> Spec:
    """Spec with the times and the compensator that the test was run with."""
    changes = Part.joined(parts).changes
    return apply(spec, changes) if changes else spec


def patched_spec(parts: Sequence[Part], spec: Spec) -> Spec:
    """Spec whose simulation behaves as recorded."""
    whole = Part.joined(parts)
    changes: dict[str, object] = dict(whole.changes)
    sections = [_flat(section) for section in whole.effects]
    if sections:
        taken = {e.name for e in spec.effects}
        names = [
            name for name in (f"found{i + 1}" for i in range(len(sections) + len(taken))) if name not in taken
        ]
        changes["effects"] = [*(e.name for e in spec.effects), *names[: len(sections)]]
        changes |= dict(zip(names, sections, strict=False))
    return apply(spec, _both_halves(changes, spec)) if changes else spec


def _both_halves(changes: dict[str, object], spec: Spec) -> dict[str, object]:
    """Changes with those of the other half of symmetric matrices, of which only one is fitted."""
    n, whole = len(spec.plant.dofs), dict(changes)
    for key, value in changes.items():
        name, place = entry_of(key) or ("", 0)
        if name in OF_PLANT:
            whole.setdefault(f"{name}[{place % n * n + place // n}]", value)
    return whole


def _flat(section: dict[str, object]) -> dict[str, object]:
    """Section with its parameters beside its block and kind, as in a spec."""
    inner = section.get("parameters")
    head = {key: value for key, value in section.items() if key != "parameters"}
    return head | inner if isinstance(inner, dict) else head
