"""A known force that reaches the plant through a lag, as behind an amplifier, a valve or a filter."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.replay.sensing import lagged
from rthm_analysis.diagnosis.result import Fault
from rthm_core.compiled import Floats
from rthm_core.topics import PLANT_STATE

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence


class ForceLag(NamedTuple):
    """Lag of first order between known forces as they were recorded and as they act.

    Attributes
    ----------
    constant : float
        Time constant, s.
    beyond : (n,) array
        What acts on each dof at the start beyond what is recorded there, N.
    """

    constant: float
    beyond: Floats

    @property
    def numbers(self) -> Floats:
        """All of it in one array."""
        return np.append(self.constant, self.beyond)

    def in_step(self, evidence: Evidence) -> Floats:
        """Loads (s, n) as they act."""
        after = np.vstack([evidence.load[1:], evidence.load[-1:]])
        lines = np.stack([evidence.load, 0.5 * (evidence.load + after), after], axis=-1)
        columns = [lagged(evidence.time, lines[:, i], self.constant) for i in range(lines.shape[1])]
        fading = np.exp(-(evidence.time - evidence.time[0]) / self.constant)
        return np.stack(columns, axis=1) + np.outer(fading, self.beyond)

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        words = (
            f"The known force acts through a lag of first order of {1e3 * self.constant:.3g} ms, as of an "
            "amplifier or a filter, or all sensors of the motion have this lag: in a linear rig that is the "
            "same. The force was smoothed so for this diagnosis; record it where it acts."
        )
        return Fault("plant", "force_lag", PLANT_STATE, words, None, self.constant)
