"""Models of the extra delay of the samples of a link.

    extra delay = delay + |N(0, spread)| + lateness,   or never, with probability `lost`

Lateness is what a busy machine does: with probability `share` an exponential time of mean `mean`. Besides,
every model allows a few samples to be anything, so that no single stall of a machine decides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import STRAY_EARLY, STRAY_LATE, STRAY_SHARE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


QUANTILES = (np.arange(6) + 0.5) / 6
"""Where the distribution of lateness is sampled when a spread comes on top."""

_erf = np.vectorize(math.erf, otypes=[float])


@dataclass(frozen=True)
class Model:
    """Distribution of the extra delay of a sample; times in s, `lost` and `share` as probabilities."""

    delay: float = 0.0
    spread: float = 0.0
    lost: float = 0.0
    share: float = 0.0
    mean: float = 1e-4

    @property
    def late(self) -> float:
        """Mean lateness, s."""
        return self.share * self.mean

    def arrived(self, x: Floats) -> Floats:
        """Probability that a sample that is neither lost nor a stray has an extra delay of at most `x`."""
        beyond = x - self.delay
        regular = self._spread_out(beyond)
        if self.share > 0.0:
            regular = (1.0 - self.share) * regular + self.share * self._late(beyond)
        return regular

    def _spread_out(self, x: Floats) -> Floats:
        if self.spread <= 0.0:
            return np.asarray((x >= 0.0).astype(float))
        return np.asarray(_erf(np.maximum(x, 0.0) / (self.spread * np.sqrt(2.0))))

    def _late(self, x: Floats) -> Floats:
        if self.spread <= 0.0:
            return np.asarray(-np.expm1(-np.maximum(x, 0.0) / self.mean))
        steps = -np.log1p(-QUANTILES) * self.mean
        return np.asarray(self._spread_out(x[..., None] - steps).mean(axis=-1))

    def probability(self, low: Floats, high: Floats) -> Floats:
        """Probability that the extra delay lies in ``(low, high]``; `high` infinite: or that it is lost."""
        never = np.isinf(high)
        up_to = np.where(never, 1.0, self._with_strays(np.where(never, 0.0, high)))
        after = np.where(np.isinf(low), 0.0, self._with_strays(np.where(np.isinf(low), 0.0, low)))
        inside = (1.0 - self.lost) * (up_to - after) + self.lost * never
        return np.asarray(np.maximum(inside, 1e-12))

    def _with_strays(self, x: Floats) -> Floats:
        early = 0.1 * np.exp(np.minimum(x, 0.0) / STRAY_EARLY)
        late = 0.9 * -np.expm1(-np.maximum(x, 0.0) / STRAY_LATE)
        return np.asarray((1.0 - STRAY_SHARE) * self.arrived(x) + STRAY_SHARE * (early + late))

    def but(self, **values: float) -> Model:
        """Return the model with other values."""
        return replace(self, **values)
