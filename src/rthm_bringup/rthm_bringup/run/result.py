"""What a run tells when it is over."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import yaml

from rthm_bringup.run.ending import Ending
from rthm_bringup.run.plan import Plan
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_analysis.outcome import Outcome

WORDS = {
    "E_fx": ("drained by the position cancellation", -1.0),
    "E_ff": ("introduced by the force feedforward", 1.0),
    "E_num": ("introduced by the numerical side", 1.0),
}
"""What the terms mean, and the sign with which they are told."""


@dataclass
class Result:
    """A run that is over.

    Attributes
    ----------
    plan, ending
        What was to be done, and how it ended.
    energies
        Last value of each term of the ledger, J; empty when the recording tells none.
    equivalent_damping
        Damper between plant and ground that would drain as much as the errors of the loop did, N s/m.
    links, clocks
        As ``rthm timing`` tells them.
    missed_deadlines
        Of all clocks; None: not known.
    outcome
        Stability, error against the ideal system, what late samples did; None: no loop, or not known.
    lost
        Samples that were published and never reached the recorder.
    problems
        Why the run, or what was made of it, is not complete; one sentence each.
    """

    plan: Plan
    ending: Ending
    energies: dict[str, float] = field(default_factory=dict)
    equivalent_damping: float | None = None
    links: dict[str, Any] = field(default_factory=dict)
    clocks: dict[str, Any] = field(default_factory=dict)
    missed_deadlines: int | None = None
    outcome: Outcome | None = None
    lost: int = 0
    problems: list[str] = field(default_factory=list)

    @property
    def status(self) -> int:
        """Exit status: 3 when the test was aborted, 1 when a node died or data were lost, else 0."""
        if self.ending.abort is not None and self.ending.reason is None:
            return 3
        return 1 if self.problems or self.lost else 0

    def as_dict(self) -> dict[str, Any]:
        """Keys of ``rthm run --json``."""
        plan = self.plan
        return {
            "bag": str(plan.bag) if plan.bag.is_dir() else None,
            "report": str(plan.report) if plan.report.is_file() else None,
            "duration": plan.duration,
            "missed_deadlines": self.missed_deadlines,
            "links": self.links,
            "clocks": self.clocks,
            "energies": self.energies,
            "equivalent_damping": self.equivalent_damping,
            "verdict": self.outcome.as_dict() if self.outcome else None,
            "lost": self.lost,
            "network": plan.network.reach,
            "hosts": {name: one and one.as_dict() for name, one in self.ending.clocks.items()},
            "zero": plan.spec.zero.model_dump() if plan.spec.zero else None,
            "predicted": self.ending.prediction.as_dict() if self.ending.prediction else None,
            "abort": self.ending.abort.as_dict() if self.ending.abort else None,
            "interrupted": self.ending.interrupted,
            "realtime": list(self.ending.realtime),
            "virtual": plan.virtual,
            "wall": self.ending.wall,
            "problems": self.problems,
        }

    def lines(self) -> list[str]:
        """What is printed."""
        told = [
            (name, value)
            for name, value in (("bag", self.plan.bag), ("report", self.plan.report))
            if value.exists()
        ]
        lines = [self.ending.abort.sentence] if self.ending.abort else []
        lines += [f"{name + ':':8}{value}" for name, value in told]
        if self.ending.prediction is not None:
            lines.append(self.ending.prediction.words)
        for name, (words, sign) in WORDS.items():
            if name in self.energies:
                lines.append(f"energy {words}: {sign * self.energies[name]:.4f} J ({name})")
        if self.equivalent_damping is not None:
            lines.append(f"equivalent damping of these three: {self.equivalent_damping:.3f} N s/m")
        if self.missed_deadlines is not None:
            lines.append(f"missed deadlines: {self._deadlines()}")
        return [*lines, *(self.outcome.lines(warned=True) if self.outcome else []), *self.problems]

    def _deadlines(self) -> str:
        if self.plan.virtual:
            return "none, in simulated time"
        granted = "with" if self.ending.realtime else "without"
        return f"{self.missed_deadlines or 'none'}, {granted} real-time priority"


def result_of(plan: Plan, ending: Ending) -> Result:
    """Analyse what was recorded, as far as there is something, and write the report."""
    result = Result(plan, ending, problems=([ending.reason] if ending.reason else []) + ending.problems)
    if ending.begin is None or "recorder" in plan.external:
        return result
    result.lost = counted_in(plan, "lost")
    if result.lost:
        result.problems.append(f"{result.lost} samples were lost on the way to the recorder.")
    twice = counted_in(plan, "twice")
    if twice:
        result.problems.append(f"{twice} samples of plant/state came twice; the driver may send each once.")
    try:
        _analyse(result)
    except InputError as error:
        result.problems.append(str(error))
    return result


def counted_in(plan: Plan, what: str) -> int:
    """Return what the recorder counted (``lost``, ``twice``), from its last words in ``metadata.yaml``."""
    file = plan.bag / "metadata.yaml"
    if not file.is_file():
        return 0
    told = yaml.safe_load(file.read_text())["rosbag2_bagfile_information"].get("custom_data") or {}
    return int(told.get(what, 0))


def _analyse(result: Result) -> None:
    from rthm_analysis.energy import energy_of
    from rthm_analysis.recording import read_recording
    from rthm_analysis.report import write_report
    from rthm_analysis.timing import timing_of

    recording = read_recording(result.plan.bag)
    timing = timing_of(recording, recording.spec)
    result.links = {name: link.as_dict() for name, link in timing.links.items()}
    result.clocks = {name: clock.as_dict() for name, clock in timing.clocks.items()}
    result.missed_deadlines = timing.missed
    result.problems += _lost_between_nodes(result)
    energy = energy_of(recording, recording.known_spec())
    result.energies = last_values(energy.as_dict())
    damping = energy.equivalent_damping
    result.equivalent_damping = damping if math.isfinite(damping) else None
    result.outcome = write_report(result.plan.bag, result.plan.report, result.ending.abort).outcome


def _lost_between_nodes(result: Result) -> list[str]:
    """Samples that a receiver waited for in vain, unless the spec itself has links that lose some."""
    lost = {name: link["lost"] for name, link in result.links.items() if link["lost"]}
    meant = any(effect.law.changes == "lost" for effect in result.plan.spec.effects)
    whole = not (result.ending.interrupted or result.ending.reason or result.ending.abort)
    return [
        f"{count} samples are missing on the link {name}: they were lost, or never sent."
        for name, count in lost.items()
        if whole and not meant
    ]


def last_values(energies: Mapping[str, Any]) -> dict[str, float]:
    """Energies at the end of a test, J; those that the recording tells."""
    found = {name: values[-1] for name, values in energies.items() if name.startswith("E_") and values}
    return {name: float(value) for name, value in found.items() if math.isfinite(value)}
