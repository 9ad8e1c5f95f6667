"""What the parts of a diagnosis say together: the verdict, and the spec that behaves as recorded."""

from __future__ import annotations

from rthm_analysis.diagnosis.criteria.verdict import PATCHED_ERROR_RATIO, RUNAWAY_ERROR_RATIO
from rthm_analysis.diagnosis.replay.entries import OF_PLANT, entry_of
from rthm_analysis.diagnosis.result import Diagnosis, Part, Verdict
from rthm_analysis.diagnosis.words import stated_spreads, verdict_words
from rthm_core.spec import Spec, apply, write_spec


def joined(parts: list[Part], spec: Spec) -> Diagnosis:
    """The parts as one answer; what to do next is left open."""
    physics = tuple(one for part in parts for one in part.physics)
    unexplained = tuple(said for part in parts for said in part.unexplained)
    retuned = {name: one for part in parts for name, one in part.retuned.items()}
    blocks = tuple(one for part in parts for one in part.blocks)
    faults = tuple(one for part in parts for one in part.faults)
    described = tuple(one for part in parts for one in part.described)
    significant = [one.block for one in blocks if one.significant]
    verdict = _verdict(parts)
    where = [*(one.block for one in faults if not one.marked), *(one.block for one in physics)]
    located = tuple(dict.fromkeys([*where, *significant]))
    traces = tuple(one for part in parts for one in part.traces)
    patched = "" if verdict == "unexplained" or not _runs(parts) else write_spec(patched_spec(parts, spec))
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
        words=verdict_words(
            verdict, located, physics, retuned, stated_spreads(spec), faults, described, traces
        ),
        curves=tuple(one for part in parts for one in part.curves),
        unexplained=unexplained,
        notes=tuple(note for part in parts for note in part.notes),
        patched=patched,
        faults=faults,
        described=described,
        traces=traces,
        refused=tuple(one for part in parts for one in part.refused),
        free_run={dof: one for part in parts for dof, one in part.free_run.items()},
    )


def _verdict(parts: list[Part]) -> Verdict:
    """Contract, section 7: what is left lowers everything; what is wrong with the recording explains."""
    if any(part.unexplained for part in parts):
        helped = any(part.physics or part.described for part in parts)
        return "improved" if helped else "unexplained"
    if any(part.physics for part in parts) or any(not one.marked for part in parts for one in part.faults):
        return "explained"
    return "retuned" if any(part.retuned for part in parts) else "match"


def _runs(parts: list[Part]) -> bool:
    """Whether a free run of the patched spec stays bounded and is no worse than that of the nominal one."""
    runs = [run for part in parts for run in part.free_run.values()]
    return all(
        run.explained < min(RUNAWAY_ERROR_RATIO, PATCHED_ERROR_RATIO * run.nominal + 1e-9) for run in runs
    )


def as_run(parts: list[Part], spec: Spec) -> Spec:
    """Spec with the times and the compensator that the test was run with."""
    changes = {name: value for part in parts for name, value in part.changes.items()}
    return apply(spec, changes) if changes else spec


def patched_spec(parts: list[Part], spec: Spec) -> Spec:
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
