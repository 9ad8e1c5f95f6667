"""Several tests against the first: differences by signal, what each test is in itself, and one verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.comparison.books import Books, books_of
from rthm_analysis.comparison.delays import delays_of
from rthm_analysis.comparison.lateness import UNKNOWN, Estimate, Lateness, lateness
from rthm_analysis.comparison.measures import peak_error
from rthm_analysis.comparison.motion import Motion, Pair, paired
from rthm_analysis.comparison.tracking import Tracking, trackings_of
from rthm_analysis.outcome.ideal import error_of
from rthm_analysis.outcome.outcome import BEYOND
from rthm_core.clock import NS
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

JUDGED = ("m", "N")
"""Units of the signals that a tolerance is for; energies follow from them."""


NAUGHT = 1e-12
"""Part of a signal up to which a difference is the arithmetic's."""


@dataclass(frozen=True)
class Difference:
    """One signal in two tests.

    Attributes
    ----------
    name, unit : str
    size : float
        Root mean square in the reference, in `unit`.
    nrmse : float
        Root mean square of the difference over `size` (J4 to J6 of a dof); NaN where the reference is at rest
        at zero.
    largest : float
        Of the difference, in `unit`.
    peak : float
        `largest` over the largest value of the reference (J7 to J9 of a dof).
    lateness : Lateness
        Delay and amplitude of the other test's signal against the reference's.
    pair : Pair
        Both at common instants.
    """

    name: str
    unit: str
    size: float
    nrmse: float
    largest: float
    peak: float
    lateness: Lateness
    pair: Pair

    @property
    def far(self) -> float:
        """`nrmse`; infinite where the reference is zero and the other is not, or the difference leaves every
        bound.
        """
        if self.largest == 0.0:
            return 0.0
        known = math.isfinite(self.nrmse) and self.largest < BEYOND
        return self.nrmse if known else math.inf

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        told = {"unit": self.unit, "rms": self.size, "nrmse": self.nrmse, "max": self.largest}
        return told | {"peak": self.peak} | self.lateness.as_dict()


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


@dataclass(frozen=True)
class Told:
    """What a test is in itself: tracking, delays and energy."""

    motion: Motion
    trackings: list[Tracking]
    delays: dict[str, Estimate]
    books: Books

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        motion = self.motion
        return {
            "source": motion.name,
            "kind": motion.kind,
            "duration": motion.duration,
            "tracking": {one.got: one.as_dict() for one in self.trackings},
            "delays": {name: one.as_dict() for name, one in self.delays.items()},
            "energy": self.books.as_dict(),
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
            why = "which is zero there" if most.largest < BEYOND else "as it leaves every bound"
            return f"differs beyond measure: {where}, {why}."
        if self.tolerance is None:
            return f"differs by {part(most.far)} at most: {where} (rms over that of the reference)."
        if self.within:
            return f"within {allowed}: differs by {part(most.far)} at most, {where}."
        return f"differs by {part(most.far)}, more than {allowed}: {where}."

    def as_dict(self) -> dict[str, object]:
        """Keys of ``rthm compare --json`` (docs/compare.md)."""
        return {
            "reference": self.reference.name,
            "tolerance": self.tolerance,
            "within": self.within,
            "words": self.words,
            "comparisons": [one.as_dict() for one in self.against],
            "sources": [one.as_dict() for one in self.told],
        }


def part(share: float) -> str:
    """Part of something in per cent; what is the arithmetic's alone is none, a dash is not known."""
    if not math.isfinite(share):
        return "boundless" if share == math.inf else "-"
    return f"{100.0 * share if abs(share) > NAUGHT else 0.0:.3g} %"


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
    against = tuple(_against(reference, other, only) for other in others)
    until = min(round(one.end * NS) for one in against)
    told = tuple(Told(one, trackings_of(one), delays_of(one), books_of(one, until)) for one in motions)
    return Comparison(told, against, tolerance)


def _against(reference: Motion, other: Motion, only: Sequence[str]) -> Against:
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
            f"{unknown[0]} is no signal of both {reference.name} and {other.name}, which have"
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


def difference(name: str, unit: str, pair: Pair) -> Difference:
    """Difference of a signal in two tests, the reference first in the pair."""
    with np.errstate(over="ignore", invalid="ignore"):  # of an unstable loop
        error = error_of(pair.other - pair.one, pair.one)
        size = float(np.sqrt(np.mean(np.square(pair.one))))
        peak = peak_error(pair.one, pair.other)
    late = lateness(*pair) if unit in JUDGED else Lateness(UNKNOWN, UNKNOWN, math.nan)
    return Difference(name, unit, size, error.nrmse, error.largest, peak, late, pair)
