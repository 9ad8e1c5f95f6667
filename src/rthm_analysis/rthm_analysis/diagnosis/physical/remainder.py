"""What a model leaves of a recording beyond the noise: where, when, and whether unseen data show it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import (
    COLOURED_STD_RATIO,
    EVENT_PARTS,
    FEWEST_NORMAL_AVERAGES,
    OUTLIER_SHARE,
    OUTLIER_STDS,
    SLOW_POWER_CHANCE,
    SLOW_POWER_COLOURED,
    SLOW_POWER_STDS,
    SLOW_POWER_WHITE,
    SLOW_SAMPLES,
)
from rthm_analysis.diagnosis.replay.readings import typical_size
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Remainder:
    """What is left of one channel.

    Attributes
    ----------
    train, held_out : float
        Power of the slow residual over that of the noise, in the training part and in the unseen one.
    rms : float
        Of the unseen residual over the noise.
    loudness : float
        Of the noise of the unseen part over that of the training part, at least 1.
    parts : (p, 2) array
        Start and end (samples) of the parts in which something is left: more than an imperfect colour of the
        noise leaves throughout.
    allowed : (float, float)
        Power of the slow residual of both parts from which something is left.
    """

    train: float
    held_out: float
    rms: float
    loudness: float
    parts: Floats
    allowed: tuple[float, float] = (SLOW_POWER_WHITE, SLOW_POWER_WHITE)

    @property
    def slow(self) -> float:
        """Power of the slow residual over that of the noise, in the part where it is larger."""
        return max(self.train, self.held_out)

    @property
    def in_train(self) -> bool:
        """Whether something is left in the training part."""
        return self.train > self.allowed[0]

    @property
    def in_held_out(self) -> bool:
        """Whether something is left in the unseen part."""
        return self.held_out > self.allowed[1]


def remainder_of(errors: Floats, train: int, white: bool = True) -> Remainder:
    """Judge the errors of one channel.

    Parameters
    ----------
    errors : (s,) array
        Over the noise and whitened; NaN where nothing was measured.
    train : int
        Samples of the training part.
    white : bool
        Whether the noise has no colour.
    """
    errors = _clipped(errors)
    edges = np.linspace(0, errors.size, EVENT_PARTS + 1).astype(int)
    held = errors[train:]
    (before, count), (after, unseen) = slow_power(errors[:train]), slow_power(held)
    throughout = 1.0 if white else max(before, 1.0)
    power = [slow_power(errors[a:b]) for a, b in pairwise(edges)]
    left = [
        (int(a), int(b))
        for a, b, (ratio, some) in zip(edges[:-1], edges[1:], power, strict=True)
        if some and ratio > throughout * _allowed(white, some)
    ]
    return Remainder(
        before,
        after,
        float(np.sqrt(np.nanmean(np.square(held)))) if np.isfinite(held).any() else 0.0,
        float(np.sqrt(max(1.0, _fast_power(held)))),
        np.array(left, dtype=float).reshape(-1, 2),
        (_allowed(white, count), _allowed(white, unseen)),
    )


def tolerance(white: bool) -> float:
    """Power of the slow residual from which something is left."""
    return SLOW_POWER_WHITE if white else SLOW_POWER_COLOURED


def _allowed(white: bool, count: int) -> float:
    """Power of so many averages from which something is left: beyond chance, and beyond the arithmetic."""
    some = max(count, 1)
    chance = SLOW_POWER_STDS * float(np.sqrt(2.0 / some))
    if some < FEWEST_NORMAL_AVERAGES:
        from scipy.special import chdtri

        chance = max(chance, float(chdtri(some, SLOW_POWER_CHANCE)) / some - 1.0)
    return 1.0 + max(tolerance(white) - 1.0, chance if white else COLOURED_STD_RATIO * chance)


def _clipped(errors: Floats) -> Floats:
    """Errors without the tails of noise that has heavy ones; as they are where these are no tails."""
    known = errors[np.isfinite(errors)]
    limit = _limit(known)
    if limit and np.count_nonzero(np.abs(known) > limit) > OUTLIER_SHARE * known.size:
        return errors
    return np.clip(errors, -limit, limit)


def _limit(values: Floats) -> float:
    """Size beyond which a value is in the tails; 0 where there are no values."""
    return OUTLIER_STDS * typical_size(values) if values.size else 0.0


def slow_power(errors: Floats, samples: int = SLOW_SAMPLES) -> tuple[float, int]:
    """Power of the slow part of some errors over that of noise, and the number of averages that tell it.

    Noise counts as 1, or as what the fastest part of the errors shows: noise that grows is no physics.
    """
    known = errors[np.isfinite(errors)]
    found = averages(known, samples)
    if not found.size:
        return 1.0, 0
    power = float(np.mean(np.square(found))) * samples
    return power / max(1.0, _fast_power(known)), found.size


def averages(values: Floats, samples: int = SLOW_SAMPLES) -> Floats:
    """Averages of a signal over so many samples, in which noise drowns and physics does not."""
    count = values.size // samples
    return np.asarray(values[: count * samples].reshape(count, samples).mean(1))


def _fast_power(errors: Floats) -> float:
    """Typical power of the fastest part of some errors, from their third differences."""
    third = np.diff(errors[np.isfinite(errors)], 3)
    if third.size < SLOW_SAMPLES:
        return 1.0
    limit = _limit(third)
    return float(np.mean(np.square(np.clip(third, -limit, limit)))) / 20.0
