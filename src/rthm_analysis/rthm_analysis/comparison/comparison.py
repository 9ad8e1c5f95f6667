"""Several tests against the first: differences by signal, what each test is in itself, and one verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rthm_analysis.comparison.against import Against, against
from rthm_analysis.comparison.balance import Balance, balance_of
from rthm_analysis.comparison.delays import delays_of
from rthm_analysis.comparison.difference import part
from rthm_analysis.comparison.lateness import Estimate
from rthm_analysis.comparison.motion import Motion
from rthm_analysis.comparison.tracking import Tracking, trackings_of
from rthm_analysis.outcome.outcome import BEYOND
from rthm_core.clock import NS
from rthm_core.errors import InputError


@dataclass(frozen=True)
class Told:
    """What a test is in itself: tracking, delays and energy."""

    motion: Motion
    trackings: list[Tracking]
    delays: dict[str, Estimate]
    balance: Balance

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        motion = self.motion
        return {
            "source": motion.name,
            "kind": motion.kind,
            "duration": motion.duration,
            "tracking": {one.got: one.as_dict() for one in self.trackings},
            "delays": {name: one.as_dict() for name, one in self.delays.items()},
            "energy": self.balance.as_dict(),
            "notes": list(motion.notes),
        }


@dataclass(frozen=True)
class Comparison:
    """Tests beside each other.

    Attributes
    ----------
    told : tuple of Told
        Every test, the reference first.
    against : tuple of Against
        The others against the reference.
    tolerance : float, optional
        Largest `nrmse` that passes.
    """

    told: tuple[Told, ...]
    against: tuple[Against, ...]
    tolerance: float | None = None

    @property
    def reference(self) -> Motion:
        """The first test."""
        return self.told[0].motion

    @property
    def within(self) -> bool | None:
        """Whether every motion and force is within the tolerance; None: there is none."""
        if self.tolerance is None:
            return None
        return self.worst.worst.far <= self.tolerance

    @property
    def worst(self) -> Against:
        """The test that differs most."""
        return max(self.against, key=lambda one: one.worst.far)

    @property
    def words(self) -> str:
        """The verdict in a line."""
        most = self.worst.worst
        where = f"{most.name} of {self.worst.name}, against {self.reference.name}"
        allowed = "" if self.tolerance is None else f"{100.0 * self.tolerance:.4g} %"
        if not math.isfinite(most.far):
            why = "which is zero there" if most.largest < BEYOND else "as it diverges"
            return f"differs beyond measure: {where}, {why}."
        if self.tolerance is None:
            return f"differs by {part(most.far)} at most: {where} (rms over that of the reference)."
        if self.within:
            return f"within {allowed}: differs by {part(most.far)} at most, {where}."
        return f"differs by {part(most.far)}, more than {allowed}: {where}."

    def as_dict(self) -> dict[str, object]:
        """Keys of ``rthm compare --json`` (docs/how-to/compare-tests.md)."""
        return {
            "reference": self.reference.name,
            "tolerance": self.tolerance,
            "within": self.within,
            "words": self.words,
            "comparisons": [one.as_dict() for one in self.against],
            "sources": [one.as_dict() for one in self.told],
        }


def compare(
    motions: Sequence[Motion], tolerance: float | None = None, only: Sequence[str] = ()
) -> Comparison:
    """Compare tests with the first of them, aligned at their starts.

    Parameters
    ----------
    motions : sequence of Motion
        Two or more.
    tolerance : float, optional
        Largest root mean square of a difference over that of the reference (0.02: 2 %).
    only : sequence of str
        Signals to compare; all by default.

    Raises
    ------
    InputError
        Fewer than two tests, a tolerance that is none, no motion or force in common, no time in common.
    """
    if len(motions) < 2:
        raise InputError(
            f"{len(motions)} source is given, but a comparison needs two or more; name another one."
        )
    if tolerance is not None and not 0.0 <= tolerance < math.inf:
        raise InputError(
            f"The tolerance is {100.0 * tolerance:g} %, but must be a number from 0; give one such as 2."
        )
    reference, *others = motions
    found = tuple(against(reference, other, only) for other in others)
    until = min(round(one.end * NS) for one in found)
    told = tuple(Told(one, trackings_of(one), delays_of(one), balance_of(one, until)) for one in motions)
    return Comparison(told, found, tolerance)
