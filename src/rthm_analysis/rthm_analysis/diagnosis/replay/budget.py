"""The work that one diagnosis may do, counted in steps of replays: a busy host gives the same answer."""

from __future__ import annotations

from dataclasses import dataclass, field
from threading import Lock

from rthm_analysis.diagnosis.criteria.replay import (
    BUDGET_MOST_RATIO,
    BUDGET_RECORDING_SAMPLES,
    BUDGET_STEPS,
    LOST_STEPS,
    REPLAY_OVERHEAD_STEPS,
)


def budget_for(samples: int, steps: float = BUDGET_STEPS) -> Budget:
    """What may be done in a recording of some samples, of which each replay takes the longer the more there
    are.
    """
    ratio = min(max(samples / BUDGET_RECORDING_SAMPLES, 1.0), BUDGET_MOST_RATIO)
    return Budget(steps * ratio, ratio=ratio)


@dataclass(frozen=True)
class Share:
    """Work for one question: another way of asking it is only begun as long as there is some left."""

    budget: Budget
    end: float

    @property
    def is_over(self) -> bool:
        """Whether it is spent: what then is left out is said."""
        over = self.budget.used > self.end
        self.budget.cut_short = self.budget.cut_short or over
        return over


@dataclass
class Budget:
    """Work that was done, and how much of it may be done.

    A search looks at it only between stages in which work is done side by side: the order of threads then
    changes nothing.
    """

    limit: float = BUDGET_STEPS
    used: float = 0.0
    cut_short: bool = False
    """Whether it was spent before more was allowed."""
    ratio: float = 1.0
    """How much more may be done than in a recording that is not long."""
    _lock: Lock = field(default_factory=Lock, repr=False)

    def charge(self, steps: float) -> None:
        """Count a replay of so many steps."""
        with self._lock:
            self.used += steps + REPLAY_OVERHEAD_STEPS

    def allow(self, more: float) -> None:
        """Let at least some more be done."""
        self.cut_short = self.cut_short or self.spent
        self.limit = max(self.limit, self.used + more)

    def share(self, steps: float) -> Share:
        """So much of the work from now on."""
        return Share(self, self.used + steps * self.ratio)

    def lose(self) -> None:
        """Let no more be done than a search is worth that is likely to find nothing."""
        self.limit = min(self.limit, self.used + LOST_STEPS * self.ratio)

    @property
    def left(self) -> float:
        """Steps that may still be simulated; below zero where it is spent."""
        return self.limit - self.used

    @property
    def spent(self) -> bool:
        """Whether no further question should be asked."""
        return self.used > self.limit

    @property
    def note(self) -> str:
        """What to say of an answer that was found within it; empty where nothing was left out."""
        if not (self.spent or self.cut_short):
            return ""
        return (
            "The search ended before everything was tried: it had simulated as much as one diagnosis may. "
            "A shorter recording, or one that is sampled less often, lets it try more."
        )
