"""What is said of a loop before it begins, if it is unstable, and the verdict on it once it is simulated."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rthm_analysis.outcome import IdealComparison, Margin, Outcome, margin_of, margin_or_why
from rthm_analysis.stability import spectral_radius
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.engine import Trajectory
    from rthm_core.spec import Spec


def is_unstable(spec: Spec) -> bool:
    """Whether a spec is that of a loop which is known to be unstable; then that is told on standard error."""
    try:
        if not spec.is_loop or spectral_radius(spec) < 1.0:
            return False
        _tell(margin_of(spec))
    except InputError:  # of what the compensator does no linear equations are known
        return False
    return True


def _tell(margin: Margin) -> None:
    print("rthm:", margin.words, file=sys.stderr, flush=True)


class Judged:
    """Gathers the verdict on a loop while it is simulated; says at once on standard error if it is unstable.

    Parameters
    ----------
    spec : Spec
        A loop.
    duration : float
        s.
    sample : float, optional
        Distance of the rows, s.
    """

    def __init__(self, spec: Spec, duration: float, sample: float | None = None) -> None:
        self._margin = margin_or_why(spec)
        if isinstance(self._margin, Margin) and not self._margin.stable:
            _tell(self._margin)
        self._beside = IdealComparison(spec, duration, sample)

    def add(self, block: Trajectory) -> None:
        """Take notice of the next rows."""
        self._beside.add(block)

    def outcome(self) -> Outcome:
        """The verdict."""
        return Outcome(self._margin, self._beside.errors())
