"""How known forces reach the plant, where it is not as they were recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol, Self

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    FORCE_LAG_BEGIN_PERIODS,
    FORCE_LEAK_TOLD_SHARE,
    FORCE_PATH_STEP,
)
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.numbers import percent
from rthm_analysis.diagnosis.replay.sensing import lagged
from rthm_analysis.diagnosis.replay.windows import period
from rthm_analysis.diagnosis.result import Fault
from rthm_core.topics import PLANT_STATE

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_core.compiled import Floats


class ForcePath(Protocol):
    """A way of known forces to the plant, given by some numbers."""

    @property
    def numbers(self) -> Floats:
        """All of them (q,)."""
        ...

    @property
    def told(self) -> Floats:
        """Those (r,) that say what it is; the others belong to one recording."""
        ...

    def at(self, numbers: Floats) -> Self:
        """The same with other numbers (q,), or with those next to them that are possible."""
        ...

    def steps(self, evidence: Evidence) -> Floats:
        """How far each number (q,) may be moved to see what it does; zero where it does nothing."""
        ...

    def in_step(self, evidence: Evidence) -> Floats:
        """Forces (s, n) on the dofs as they act, N."""
        ...

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        ...


class ForceLag(NamedTuple):
    """Lag of first order, as of an amplifier, a valve or a filter.

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
        return cls(FORCE_LAG_BEGIN_PERIODS * period(evidence), np.zeros(evidence.load.shape[1]))

    @property
    def numbers(self) -> Floats:
        """All of it in one array."""
        return np.append(self.constant, self.beyond)

    @property
    def told(self) -> Floats:
        """The time constant."""
        return np.array([self.constant])

    def at(self, numbers: Floats) -> Self:
        """The same with other numbers (1 + n,), and a time constant of at least a third and at most three
        times this one.
        """
        constant = float(np.clip(numbers[0], self.constant / 3.0, 3.0 * self.constant))
        return self._replace(constant=constant, beyond=numbers[1:])

    def steps(self, evidence: Evidence) -> Floats:
        """A small part of the time constant, and of the largest force on each dof."""
        return FORCE_PATH_STEP * np.append(self.constant, np.abs(evidence.load).max(axis=0))

    def in_step(self, evidence: Evidence) -> Floats:
        """Forces (s, n) as they act."""
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


class ForceLeak(NamedTuple):
    """Forces on a dof of which a share acts on others as well, as of an actuator that pushes askew.

    Attributes
    ----------
    dofs : tuple of n str
        Of the plant.
    pairs : tuple of q (int, int)
        The dof with the force, and one on which a share of it acts.
    numbers : (q,) array
        Shares.
    """

    dofs: tuple[str, ...]
    pairs: tuple[tuple[int, int], ...]
    numbers: Floats

    @classmethod
    def begun(cls, evidence: Evidence, dofs: tuple[str, ...]) -> Self:
        """No share of any force, where a fit of them begins."""
        pushed = np.flatnonzero(np.any(evidence.load, axis=0)).tolist()
        pairs = tuple((i, j) for i in pushed for j in range(len(dofs)) if i != j)
        return cls(dofs, pairs, np.zeros(len(pairs)))

    @property
    def told(self) -> Floats:
        """All shares."""
        return self.numbers

    def at(self, numbers: Floats) -> Self:
        """The same with other shares (q,)."""
        return self._replace(numbers=numbers)

    def steps(self, evidence: Evidence) -> Floats:
        """A small part of every force."""
        return np.full(len(self.pairs), FORCE_PATH_STEP)

    def in_step(self, evidence: Evidence) -> Floats:
        """Forces (s, n) as they act."""
        acting = evidence.load.copy()
        for (here, there), share in zip(self.pairs, self.numbers, strict=True):
            acting[:, there] += share * evidence.load[:, here]
        return acting

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it: every share that is not small beside the largest."""
        largest = float(max(self.numbers, key=abs))
        said = enumerated(
            [
                f"{percent(share)} of the known force on {self.dofs[here]} acts on {self.dofs[there]}"
                for (here, there), share in zip(self.pairs, self.numbers, strict=True)
                if abs(share) > FORCE_LEAK_TOLD_SHARE * abs(largest)
            ]
        )
        words = (
            f"{said}, beside the force on its own dof: it pushes askew, or on several dofs. It was added for "
            "this diagnosis; record what acts on every dof."
        )
        return Fault("plant", "force_leak", PLANT_STATE, words, None, largest)
