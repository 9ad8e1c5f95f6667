"""A test against another: the signals that both have, over the time that both have."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rthm_analysis.comparison.difference import JUDGED, Difference, difference
from rthm_analysis.comparison.lateness import UNKNOWN, Estimate
from rthm_analysis.comparison.motion import Motion, paired
from rthm_core.clock import NS
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True)
class Against:
    """A test against the reference.

    Attributes
    ----------
    name : str
    begin, end : float
        Time in which both are known, s since the start of each.
    differences : dict of Difference
        By signal, those that both have.
    missing : tuple of str
        Signals that only one of the two has.
    """

    name: str
    begin: float
    end: float
    differences: dict[str, Difference]
    missing: tuple[str, ...]

    @property
    def judged(self) -> dict[str, Difference]:
        """Motion and forces."""
        return {name: one for name, one in self.differences.items() if one.unit in JUDGED}

    @property
    def worst(self) -> Difference:
        """The motion or force that differs most; one that no number can be told of counts as such."""
        return max(self.judged.values(), key=lambda one: one.far)

    @property
    def offset(self) -> Estimate:
        """Time offset between the two tests, s, + where this one is late: of the position that tells best."""
        known = [
            one.lateness.delay
            for one in self.judged.values()
            if one.unit == "m" and math.isfinite(one.lateness.delay.value)
        ]
        return min(known, key=lambda one: one.std, default=UNKNOWN)

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {
            "source": self.name,
            "overlap": [self.begin, self.end],
            "offset": self.offset.as_dict(),
            "nrmse": self.worst.nrmse,
            "signal": self.worst.name,
            "signals": {name: one.as_dict() for name, one in self.differences.items()},
            "missing": list(self.missing),
        }


def against(reference: Motion, other: Motion, only: Sequence[str] = ()) -> Against:
    """Compare a test with a reference, aligned at their starts.

    Parameters
    ----------
    reference, other : Motion
    only : sequence of str
        Signals to compare; all by default.

    Raises
    ------
    InputError
        No motion or force is asked for that both have, or they have no time in common.
    """
    names = _common(reference, other, only)
    differences = {one.name: one for one in _differences(reference, other, names)}
    judged = [one for one in differences.values() if one.unit in JUDGED]
    if not judged:
        spans = [f"{one.name} from {_first(one):.4g} to {one.duration:.4g} s" for one in (reference, other)]
        raise InputError(
            f"{' and '.join(spans)} have no time in common, counted from their starts; compare tests that"
            " overlap."
        )
    begin, end = min(one.pair.time[0] for one in judged), max(one.pair.time[-1] for one in judged)
    missing = reference.signals.keys() ^ other.signals.keys()
    return Against(other.name, float(begin), float(end), differences, tuple(sorted(missing)))


def _first(motion: Motion) -> float:
    return motion.signals[motion.dofs[0]].begin_ns / NS


def _common(reference: Motion, other: Motion, only: Sequence[str]) -> list[str]:
    """Signals of both tests that are asked for, those of the motion first."""
    common = [name for name in reference.signals if name in other.signals]
    unknown = [name for name in only if name not in common]
    if unknown:
        raise InputError(
            f"{unknown[0]} is not a signal of both {reference.name} and {other.name}, which have"
            f" {', '.join(common) or 'none'} in common; name one of these, or leave out --only."
        )
    found = [name for name in common if not only or name in only]
    if not any(reference.signals[name].unit in JUDGED for name in found):
        theirs = [
            ", ".join(name for name, one in motion.signals.items() if one.unit in JUDGED)
            for motion in (reference, other)
        ]
        raise InputError(
            f"{reference.name} has the signals {theirs[0]}, {other.name} has {theirs[1]}, and none of motion"
            " or force is asked for in both; compare tests of the same rig, or rename with rthm import."
        )
    return found


def _differences(reference: Motion, other: Motion, names: Sequence[str]) -> Iterator[Difference]:
    for name in names:
        one = reference.signals[name]
        pair = paired(one, other.signals[name])
        if pair.time.size > 1:
            yield difference(name, one.unit, pair)
