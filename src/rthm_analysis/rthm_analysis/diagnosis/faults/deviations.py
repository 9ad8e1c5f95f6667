"""By what a recording deviates from what acted and moved: a protocol that a fit of its numbers needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, Self

from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_analysis.diagnosis.result import Fault


class Deviation(Protocol):
    """What is wrong with a whole recording, given by some numbers."""

    @property
    def numbers(self) -> Floats:
        """All of them (q,)."""
        ...

    @property
    def told(self) -> Floats:
        """Those (r,) that say what it is."""
        ...

    def at(self, numbers: Floats) -> Self:
        """The same with other numbers (q,), or with those next to them that are possible."""
        ...

    def steps(self, evidence: Evidence) -> Floats:
        """How far each number (q,) may be moved to see what it does; zero where it does nothing."""
        ...

    def corrected(self, evidence: Evidence) -> Evidence:
        """A recording without it."""
        ...

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        ...
