"""What leaks from one dof to another: a share of a known force, or of what a sensor reads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from typing import Self

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import DEVIATION_STEP, LEAK_TOLD_SHARE
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.numbers import percent
from rthm_analysis.diagnosis.replay.evidence import MOTION, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.compiled import Floats
from rthm_core.topics import PLANT_STATE

CROSSTALK = "crosstalk"
"""Kind of the fault of sensors."""


@dataclass(frozen=True)
class Leak:
    """Columns of a recording of which shares are also in other columns.

    Attributes
    ----------
    pairs : tuple of q (int, int)
        A column, and the one that a share of it is in.
    numbers : (q,) array
        Shares.
    """

    pairs: tuple[tuple[int, int], ...]
    numbers: Floats

    @classmethod
    def begun(cls, pairs: Iterable[tuple[int, int]]) -> Self:
        """No share of any column, where a fit of them begins."""
        found = tuple(pairs)
        return cls(found, np.zeros(len(found)))

    @property
    def told(self) -> Floats:
        """All shares."""
        return self.numbers

    def at(self, numbers: Floats) -> Self:
        """The same with other shares (q,)."""
        return replace(self, numbers=numbers)

    def steps(self, evidence: Evidence) -> Floats:
        """A small part of every column."""
        return np.full(len(self.pairs), DEVIATION_STEP)

    @property
    def shares(self) -> list[tuple[float, int, int]]:
        """Share, its column and the other one: the largest, and all that are not small beside it."""
        found = [(float(share), *pair) for share, pair in zip(self.numbers, self.pairs, strict=True)]
        found.sort(key=lambda one: -abs(one[0]))
        return [one for one in found if abs(one[0]) >= LEAK_TOLD_SHARE * abs(found[0][0])]

    def added(self, columns: Floats, sign: float) -> Floats:
        """Columns (s, c) with the shares of others in them, or without."""
        found = columns.copy()
        for (here, there), share in zip(self.pairs, self.numbers, strict=True):
            found[:, there] += sign * share * columns[:, here]
        return found


@dataclass(frozen=True)
class ForceLeak(Leak):
    """Known forces on a dof of which a share acts on others as well, as of an actuator that pushes askew.

    Attributes
    ----------
    dofs : tuple of str
        Of the plant.
    """

    dofs: tuple[str, ...] = ()

    @classmethod
    def of(cls, evidence: Evidence, dofs: Sequence[str]) -> Self:
        """The forces of a recording, whose shares are to be found."""
        pairs = permutations(range(len(dofs)), 2)
        begun = cls.begun(pair for pair in pairs if np.any(evidence.load[:, pair[0]]))
        return replace(begun, dofs=tuple(dofs))

    def corrected(self, evidence: Evidence) -> Evidence:
        """A recording with the forces as they act."""
        return replace(evidence, load=self.added(evidence.load, 1.0))

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        said = enumerated(
            f"{percent(share)} of the known force on {self.dofs[here]} acts on {self.dofs[there]}"
            for share, here, there in self.shares
        )
        words = (
            f"{said}, beside the force on its own dof: it pushes askew, or on several dofs. It was added for "
            "this diagnosis; record what acts on every dof."
        )
        return Fault("plant", "force_leak", PLANT_STATE, words, None, self.shares[0][0])


@dataclass(frozen=True)
class Crosstalk(Leak):
    """Sensors that read, beside their own dof, a share of what those of the same kind at others read."""

    @classmethod
    def of(cls, evidence: Evidence) -> Self:
        """The sensors of a recording, whose shares are to be found."""
        channels = evidence.channels
        return cls.begun(
            (here, there)
            for here, there in permutations(range(len(channels)), 2)
            if channels[here].family == channels[there].family in MOTION
        )

    def corrected(self, evidence: Evidence) -> Evidence:
        """A recording without these shares."""
        return replace(evidence, measured=self.added(evidence.measured, -1.0))

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        said = enumerated(
            f"{percent(share)} of {in_words(evidence.channels[here])} is in the reading of "
            f"{in_words(evidence.channels[there])}"
            for share, here, there in self.shares
        )
        words = (
            f"{said}: the channels are not apart, as in an amplifier or a multiplexer. It was taken out for "
            "this diagnosis; move one dof alone and see what the others read."
        )
        share, _, there = self.shares[0]
        return fault_of(evidence.channels[there], CROSSTALK, words, None, share)
