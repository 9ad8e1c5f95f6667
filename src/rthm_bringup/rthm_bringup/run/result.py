"""What a run tells when it is over."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from rthm_bringup.run.ending import Ending
from rthm_bringup.run.plan import Plan

LINES = (
    ("E_fx", "energy drained by the position cancellation"),
    ("E_ff", "energy introduced by the force feedforward"),
    ("E_num", "energy introduced by the numerical side"),
)


@dataclass
class Result:
    """A run that is over.

    Attributes
    ----------
    energies
        Last value of each term, J; empty when the recording tells none.
    equivalent_damping
        Damper between the mass of the plant and the ground that would drain as much, N s/m.
    lost
        Samples that were published and are not in the recording.
    problem
        Why the run, or what was made of it, is not complete.
    """

    plan: Plan
    ending: Ending
    energies: dict[str, float] = field(default_factory=dict)
    equivalent_damping: float | None = None
    links: dict[str, Any] = field(default_factory=dict)
    missed_deadlines: int | None = None
    lost: int = 0
    problem: str | None = None
    has_report: bool = False

    @property
    def status(self) -> int:
        """Exit status: 0, or 1 when a node died or data were lost."""
        return 1 if self.problem or self.lost else 0
