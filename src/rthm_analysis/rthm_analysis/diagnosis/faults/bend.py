"""The bend of a sensor that is not linear: how far its readings are off, over what they should be."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    BENT_DEGREE,
    BENT_DEGREE_BESIDE,
    BENT_GAIN,
    BENT_PART_SAMPLES,
    BENT_PERIODS,
    BENT_REPEATING_SHARE,
    BENT_ROUNDS,
    BENT_TRIALS,
)
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.stretches import with_column
from rthm_analysis.diagnosis.numbers import with_unit
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF, Channel, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.compiled import Floats

NONLINEAR = "nonlinear"
"""Kind of the fault."""


@dataclass(frozen=True)
class Bend:
    """Error of a reading that depends on the true value.

    Attributes
    ----------
    low, high : float
        Range of the true values.
    period : float or None
        Distance after which a part of it repeats.
    sizes : (g,) or (g + 2,) array
        Of the powers of a value from the middle of the range on, over half of it; of sine and cosine.
    """

    low: float
    high: float
    period: float | None
    sizes: Floats

    def error(self, true: Floats) -> Floats:
        """By how much true values are read too high; beyond the range as at its end."""
        return np.asarray(_shapes(true, (self.low, self.high), self.period) @ self.sizes)

    def true(self, reading: Floats) -> Floats:
        """True values of readings; NaN beyond the range."""
        found = reading
        for _ in range(BENT_ROUNDS):
            found = reading - self.error(found)
        return np.where((found >= self.low) & (found <= self.high), found, np.nan)


def bend_of(true: Floats, error: Floats, beside: Floats | None = None) -> Bend:
    """Smooth curve, and what repeats along the range where that explains most of the rest, of errors (s,) at
    true values (s,); `beside` (s, q) is what else may be in them, of any size.
    """
    others = np.empty((true.size, 0)) if beside is None else beside
    ends = float(true.min()), float(true.max())

    def fitted(period: float | None) -> tuple[Bend, float]:
        shapes = _shapes(true, ends, period)
        basis = np.hstack([shapes, others])
        sizes = np.linalg.lstsq(basis, error, rcond=None)[0]
        left = float(np.sum(np.square(error - basis @ sizes)))
        return Bend(*ends, period, np.asarray(sizes[: shapes.shape[1]], dtype=float)), left

    plain, rest = fitted(None)
    bend, left = fitted(_period(lambda one: fitted(one)[1], ends[1] - ends[0]))
    repeats = rest - left > max(BENT_GAIN * rest, BENT_REPEATING_SHARE * float(error @ error))
    return bend if repeats else plain


def _period(cost: Callable[[float], float], span: float) -> float:
    """Period at which a cost is least, of those that a range holds several times."""
    from scipy.optimize import minimize_scalar

    counts = np.geomspace(*BENT_PERIODS, BENT_TRIALS)
    best = counts[int(np.argmin([cost(span / count) for count in counts]))]
    step = BENT_PERIODS[1] / BENT_PERIODS[0]
    ends = best * step ** (np.array([-1.0, 1.0]) / BENT_TRIALS)
    found = minimize_scalar(lambda count: cost(span / count), bounds=ends, method="bounded")
    return span / float(found.x)


def _shapes(true: Floats, ends: tuple[float, float], period: float | None) -> Floats:
    """Powers of values (s,), and sine and cosine of a period, as columns."""
    low, high = ends
    half = max(0.5 * (high - low), 1e-300)
    z = (np.clip(true, low, high) - 0.5 * (low + high)) / half
    columns = np.vander(z, (BENT_DEGREE if period is None else BENT_DEGREE_BESIDE) + 1, increasing=True)
    if period is None:
        return np.asarray(columns)
    phase = 2.0 * np.pi * half * z / period
    return np.concatenate([columns, np.stack([np.sin(phase), np.cos(phase)], axis=-1)], axis=-1)


def curve_share(true: Floats, error: Floats) -> float:
    """Part of errors (s,), beside an offset and a gain, that their means over equal parts of the range of the
    true values explain.
    """
    low, high = float(true.min()), float(true.max())
    parts = true.size // BENT_PART_SAMPLES
    part = np.minimum((true - low) / max(high - low, 1e-300) * parts, parts - 1).astype(int)
    away = _beside_line(true, error)
    sums, counts = (np.bincount(part, weights, parts) for weights in (away, None))
    explained = float(np.sum(np.square(sums) / np.maximum(counts, 1)))
    return explained / max(float(away @ away), 1e-300)


def share_of(bend: Bend, true: Floats, error: Floats) -> float:
    """Part of errors (s,), beside an offset and a gain, that a bend explains within its range."""
    rest = error - bend.error(true)
    inside = (true >= bend.low) & (true <= bend.high)
    whole, left = (_beside_line(true[inside], one[inside]) for one in (error, rest))
    return 1.0 - float(left @ left) / max(float(whole @ whole), 1e-300)


def _beside_line(true: Floats, error: Floats) -> Floats:
    """Errors that no offset and no gain explain."""
    basis = np.stack([np.ones_like(true), true - true.mean()], axis=1)
    return np.asarray(error - basis @ np.linalg.lstsq(basis, error, rcond=None)[0])


def straightened(evidence: Evidence, bends: Mapping[Channel, Bend]) -> tuple[Evidence, tuple[Fault, ...]]:
    """Take the bends of some channels out of their readings, and tell them."""
    faults = []
    for channel, bend in bends.items():
        column = evidence.channels.index(channel)
        readings = evidence.measured[:, column]
        true = bend.true(readings)
        evidence = with_column(evidence, column, true)
        faults.append(_fault(channel, bend, float(np.nanmax(np.abs(readings - true)))))
    return evidence, tuple(faults)


def _fault(channel: Channel, bend: Bend, largest: float) -> Fault:
    unit = UNIT_OF[channel.family]
    repeats = "" if bend.period is None else f", and repeats every {with_unit(bend.period, unit)}"
    words = (
        f"The sensor of {in_words(channel)} is not linear: its error depends on the reading, is up to "
        f"{with_unit(largest, unit)}{repeats}. It was taken out for this diagnosis; calibrate the sensor "
        "over its whole range."
    )
    return fault_of(channel, NONLINEAR, words, value=largest)
