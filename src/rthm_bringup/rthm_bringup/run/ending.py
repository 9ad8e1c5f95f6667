"""How a session ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rthm_core.clocks import Offset
from rthm_core.events import Abort

if TYPE_CHECKING:
    from rthm_bringup.run.prediction import Prediction


@dataclass
class Ending:
    """What is known when the last process is gone.

    Attributes
    ----------
    reason
        Why the test could not go on, in one sentence; None: it ended as planned, or by Ctrl-C.
    abort
        Which limit ended it; None: none did.
    problems
        What went wrong without ending it, one sentence each.
    interrupted
        Whether Ctrl-C ended it.
    begin
        Start of the test, ns; None: it never began.
    wall
        How long the test took, s of the wall clock; None: it did not come to its end.
    realtime
        Nodes of the loop that the system gave real-time priority.
    diagnostics
        What each node told last, by the name of its status.
    clocks
        Offsets of the clocks of parts that run elsewhere, measured last; None where none was told.
    prediction
        What the exact engine predicts of a test with a real machine.
    """

    reason: str | None = None
    abort: Abort | None = None
    problems: list[str] = field(default_factory=list)
    interrupted: bool = False
    begin: int | None = None
    wall: float | None = None
    realtime: tuple[str, ...] = ()
    clocks: dict[str, Offset | None] = field(default_factory=dict)
    prediction: Prediction | None = None
    diagnostics: dict[str, dict[str, str]] = field(default_factory=dict)

    def note(self, problem: str) -> None:
        """Remember a problem, once."""
        if problem not in self.problems:
            self.problems.append(problem)
