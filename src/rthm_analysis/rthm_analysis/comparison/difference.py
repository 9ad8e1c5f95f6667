"""One signal in two tests."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rthm_analysis.comparison.lateness import UNKNOWN, Lateness, lateness
from rthm_analysis.comparison.measures import peak_error
from rthm_analysis.comparison.motion import Pair
from rthm_analysis.outcome.ideal import error_of
from rthm_analysis.outcome.outcome import BEYOND

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


def part(share: float) -> str:
    """Part of something in per cent; what is the arithmetic's alone is none, a dash is not known."""
    if not math.isfinite(share):
        return "boundless" if share == math.inf else "-"
    return f"{100.0 * share if abs(share) > NAUGHT else 0.0:.3g} %"


def difference(name: str, unit: str, pair: Pair) -> Difference:
    """Difference of a signal in two tests, the reference first in the pair."""
    with np.errstate(over="ignore", invalid="ignore"):  # of an unstable loop
        error = error_of(pair.other - pair.one, pair.one)
        size = float(np.sqrt(np.mean(np.square(pair.one))))
        peak = peak_error(pair.one, pair.other)
    late = lateness(*pair) if unit in JUDGED else Lateness(UNKNOWN, UNKNOWN, math.nan)
    return Difference(name, unit, size, error.nrmse, error.largest, peak, late, pair)
