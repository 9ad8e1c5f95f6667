"""Fit models of the extra delay to the uses of a link, and choose between them on uses not fitted to.

Each model has lateness beside what it names, so a busy machine is no physics.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import (
    EARLY_TELLS_NS,
    FINE_GRAIN_NS,
    LINK_BLOCKS,
    LINK_BOUNDS,
    MOST_DIFFERENT_INTERVALS,
)
from rthm_analysis.diagnosis.links.models import Model
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.links.evidence import LinkEvidence
    from rthm_core.compiled import Floats, Integers


def _odds(p: float) -> float:
    return math.log(p / (1.0 - p))


def _share(z: float) -> float:
    return 1.0 / (1.0 + math.exp(-z))


_ENCODE: dict[str, Callable[[float], float]] = {
    "delay": float,
    "spread": math.log,
    "mean": math.log,
    "lost": _odds,
    "share": _odds,
}
_DECODE: dict[str, Callable[[float], float]] = {
    "delay": float,
    "spread": math.exp,
    "mean": math.exp,
    "lost": _share,
    "share": _share,
}

INFINITE_GRAINS = 100_000_000
"""Multiples of the grain that stand for infinity."""


@dataclass(frozen=True)
class Counted:
    """Intervals of extra delays and how often each occurs.

    Attributes
    ----------
    low, high : (n,) arrays
        s.
    count : (n,) array
    """

    low: Floats
    high: Floats
    count: Floats

    def total(self, model: Model) -> float:
        """Logarithm of the likelihood of all samples."""
        return float(self.count @ np.log(model.probability(self.low, self.high)))

    @property
    def samples(self) -> float:
        """How many samples there are."""
        return float(self.count.sum())


def grain(evidence: LinkEvidence) -> int:
    """Width in ns to which intervals are widened, so that equal ones can be counted."""
    if evidence.clocked:
        return (
            FINE_GRAIN_NS
            if _different(evidence, FINE_GRAIN_NS) <= MOST_DIFFERENT_INTERVALS
            else 10 * FINE_GRAIN_NS
        )
    used = evidence.high[np.isfinite(evidence.high)]
    low, high = np.quantile(used, [0.1, 0.9]) if used.size else (0.0, 0.0)
    return max(FINE_GRAIN_NS, int((high - low) * 1e9 / 60))


def _different(evidence: LinkEvidence, width: int) -> int:
    """How many intervals are not the same within a width in ns."""
    known = np.isfinite(evidence.low) & np.isfinite(evidence.high)
    ends = np.stack([evidence.low[known], evidence.high[known]]) * (NS / width)
    return int(np.unique(np.rint(ends), axis=1).shape[1])


def counted(evidence: LinkEvidence, samples: Integers | None = None, width: int | None = None) -> Counted:
    """Count intervals of some samples, by default of all that tell anything, with the `grain` as width."""
    width = width or grain(evidence)
    tells = np.isfinite(evidence.high) | (evidence.low * 1e9 > -EARLY_TELLS_NS)
    which = np.flatnonzero(tells) if samples is None else samples[tells[samples]]
    low, high = evidence.low[which] * 1e9, evidence.high[which] * 1e9
    middle = np.rint(0.5 * (low + high) / width) if not evidence.clocked else 0.0
    below = np.where(np.isfinite(low), np.floor(low / width), -INFINITE_GRAINS)
    above = np.where(np.isfinite(high), np.ceil(high / width), INFINITE_GRAINS)
    if not evidence.clocked:
        below = np.where(np.isfinite(high), middle - 0.5, below)
        above = np.where(np.isfinite(high), middle + 0.5, above)
    ends = np.stack([below, above])
    halves = (2.0 * ends).astype(np.int64) + 4 * INFINITE_GRAINS
    _, first, count = np.unique(
        halves[0] * (8 * INFINITE_GRAINS) + halves[1], return_index=True, return_counts=True
    )
    ends = ends[:, first]
    ends = np.where(np.abs(ends) >= INFINITE_GRAINS, np.copysign(np.inf, ends), ends * width / NS)
    return Counted(ends[0], ends[1], count.astype(float))


def folds(evidence: LinkEvidence) -> tuple[Counted, Counted]:
    """Even and odd blocks of time."""
    known = np.flatnonzero(np.isfinite(evidence.low))
    odd, width = np.arange(known.size) * LINK_BLOCKS // max(known.size, 1) % 2 == 1, grain(evidence)
    return counted(evidence, known[~odd], width), counted(evidence, known[odd], width)


def most_common(data: Counted) -> tuple[float, float]:
    """Extra delays, from and up to, that most samples can have."""
    ends = np.concatenate([data.low, data.high])
    steps = np.concatenate([data.count, -data.count])
    finite = np.isfinite(ends)
    order = np.argsort(ends[finite], kind="stable")
    at, height = ends[finite][order], np.cumsum(steps[finite][order])
    height += data.count[np.isinf(data.low)].sum()
    last = np.append(np.diff(at) > 0, True)
    at, height = at[last], height[last]
    best = int(np.argmax(height))
    return float(at[best]), float(at[min(best + 1, at.size - 1)])


def fitted(data: Counted, kinds: tuple[str, ...], late: bool, near: Model | None = None) -> Model:
    """Most likely model in which `kinds`, and with `late` also lateness, are not zero.

    Parameters
    ----------
    near : Model, optional
        Where to begin; for the same kinds, fitted to similar data.
    """
    names = (*kinds, "share", "mean") if late else kinds
    if near is not None:
        return _searched(data, names, near, 0.2)
    start = _start(data, kinds)
    if names == ("delay",) or not names:
        return start
    if not late:
        return _searched(data, names, start, 0.7)
    typical = max(_median_wait(data), 1e-5)
    ways = [start.but(share=0.05, mean=3e-4)]
    ways += [start.but(share=0.95, mean=mean) for mean in (0.5 * typical, 1e-4)]
    found = [_searched(data, names, way, 0.7) for way in ways]
    return max(found, key=data.total)


def _median_wait(data: Counted) -> float:
    """Median of what samples that are late waited at most, s; 0: none is late."""
    late = np.isfinite(data.high) & (data.high > 0.0)
    order = np.argsort(data.high[late])
    total = np.cumsum(data.count[late][order])
    return float(data.high[late][order][np.searchsorted(total, 0.5 * total[-1])]) if total.size else 0.0


def _start(data: Counted, kinds: tuple[str, ...]) -> Model:
    """Rough model without lateness; a delay is what most samples can have."""
    return Model(
        delay=0.5 * sum(most_common(data)) if "delay" in kinds else 0.0,
        spread=max(_median_wait(data), 2e-5) if "spread" in kinds else 0.0,
        lost=0.02 if "lost" in kinds else 0.0,
    )


def _searched(data: Counted, names: tuple[str, ...], start: Model, reach: float) -> Model:
    """Best model that a simplex search finds from `start`."""
    if not names:
        return start
    from scipy.optimize import minimize

    steps = np.array([reach * max(0.3 * abs(start.delay), 1e-4) if n == "delay" else reach for n in names])
    origin = _encoded(start, names)

    def unlikely(z: Floats) -> float:
        return -data.total(_decoded(z, names))

    found = minimize(
        unlikely,
        origin,
        method="Nelder-Mead",
        options={
            "initial_simplex": np.vstack([origin, origin + np.diag(steps)]),
            "maxfev": 20 + 25 * len(names),
            "fatol": 0.02,
            "xatol": 1e-4,
        },
    )
    best = _decoded(found.x, names)
    return best if data.total(best) >= data.total(start) else start


def _encoded(model: Model, names: tuple[str, ...]) -> Floats:
    return np.array(
        [_ENCODE[name](float(np.clip(getattr(model, name), *LINK_BOUNDS[name]))) for name in names]
    )


def _decoded(z: Floats, names: tuple[str, ...]) -> Model:
    values = {}
    for name, value in zip(names, z.tolist(), strict=True):
        low, high = LINK_BOUNDS[name]
        values[name] = min(max(_DECODE[name](min(max(value, -50.0), 50.0)), low), high)
    return Model(**values)


Fitted = tuple[Model, tuple[str, ...]]
"""A model and its kinds."""


def gain(data: tuple[Counted, Counted], richer: Fitted, simpler: Fitted) -> float:
    """By how much `richer` is more likely than `simpler` on the half that it was not fitted to, in nats.

    Parameters
    ----------
    richer, simpler : (Model, tuple of str)
        Fitted to all data; their search begins there.
    """
    total = 0.0
    for fit, judge in (data, data[::-1]):
        for sign, (near, kinds) in ((1.0, richer), (-1.0, simpler)):
            late = near.share > 0.0
            begin = near if late or kinds != ("delay",) else None
            total += sign * judge.total(fitted(fit, kinds, late, begin))
    return total


def deviation(data: Counted, model: Model, kind: str) -> float:
    """Standard deviation of a parameter of a fitted model, from the curvature of the likelihood."""
    low, high = most_common(data)
    if kind == "delay" and model.share == 0.0 and model.spread == 0.0:
        return max(high - low, 1e-6) / math.sqrt(12.0)
    value = getattr(model, kind)
    step = 0.03 * abs(value) if kind != "delay" else max(0.1 * (model.late + model.spread), 1e-6)
    sides = [data.total(model.but(**{kind: value + sign * step})) for sign in (-1.0, 1.0)]
    drop = max(data.total(model) - 0.5 * sum(sides), 1e-3)
    return step / math.sqrt(2.0 * drop)
