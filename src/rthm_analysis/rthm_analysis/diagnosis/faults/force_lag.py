"""A known force that reaches the plant through a lag, as behind an amplifier, a valve or a filter."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import DEVIATION_STEP, FORCE_LAG_BEGIN_PERIODS
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.sensing import lagged
from rthm_analysis.diagnosis.result import Fault
from rthm_core.compiled import Floats
from rthm_core.topics import PLANT_STATE


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

    @classmethod
    def begun(cls, evidence: Evidence) -> Self:
        """Where a fit of it begins."""
        return cls(FORCE_LAG_BEGIN_PERIODS * evidence.period, np.zeros(evidence.load.shape[1]))

    @property
    def numbers(self) -> Floats:
        """All of it in one array."""
        return np.append(self.constant, self.beyond)

    @property
    def told(self) -> Floats:
        """The time constant: the rest is of one recording."""
        return np.array([self.constant])

    def at(self, numbers: Floats) -> Self:
        """The same with other numbers (1 + n,), and a time constant of at least a third and at most three
        times this one.
        """
        constant = float(np.clip(numbers[0], self.constant / 3.0, 3.0 * self.constant))
        return self._replace(constant=constant, beyond=numbers[1:])

    def steps(self, evidence: Evidence) -> Floats:
        """A small part of the time constant, and of the largest force on each dof."""
        return DEVIATION_STEP * np.append(self.constant, np.abs(evidence.load).max(axis=0))

    def corrected(self, evidence: Evidence) -> Evidence:
        """A recording with the forces as they act."""
        after = np.vstack([evidence.load[1:], evidence.load[-1:]])
        lines = np.stack([evidence.load, 0.5 * (evidence.load + after), after], axis=-1)
        columns = [lagged(evidence.time, lines[:, i], self.constant) for i in range(lines.shape[1])]
        fading = np.exp(-(evidence.time - evidence.time[0]) / self.constant)
        return replace(evidence, load=np.stack(columns, axis=1) + np.outer(fading, self.beyond))

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        words = (
            f"The known force acts through a lag of first order of {1e3 * self.constant:.3g} ms, as of an "
            "amplifier or a filter, or all sensors of the motion have this lag: in a linear rig that is the "
            "same. The force was smoothed so for this diagnosis; record it where it acts."
        )
        return Fault("plant", "force_lag", PLANT_STATE, words, None, self.constant)
