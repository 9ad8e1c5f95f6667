"""What readings of a channel tell by themselves: how noisy they are, and the step of their rounding."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import (
    LATTICE_LAST_DIGIT_SHARE,
    LATTICE_MOST_DIGITS,
    LATTICE_MOST_VALUES,
    LATTICE_TOLERANCE,
    NOISE_MEDIAN_TO_RMS,
    NOISE_RMS_TO_MEDIAN,
    REPLAY_RESOLUTION,
    ROUNDING_STEP_TO_NOISE,
    TAIL_LAGS,
    TAIL_STDS,
    TAILS_FEWEST_SAMPLES,
    TAILS_LEAST,
    TAILS_MOST,
    TAILS_PARTS,
    TAILS_TOGETHER_RATIO,
)
from rthm_core.compiled import Floats


def noise_level(residual: Floats, measured: Floats) -> float:
    """Standard deviation of white noise on one channel, in its unit.

    Parameters
    ----------
    residual : (s,) array
        Measured minus simulated; smooth mismatch does not matter.
    measured : (s,) array
        NaN where not known.
    """
    third = np.diff(residual[np.isfinite(residual)], 3) / np.sqrt(20.0)
    if not third.size:
        return float("nan")
    typical = typical_size(third)
    spread = float(np.sqrt(np.mean(np.square(third))))
    if typical > NOISE_MEDIAN_TO_RMS * spread:
        level = typical * _tails(third)
    else:
        level = min(spread, NOISE_RMS_TO_MEDIAN * typical) if typical > 0.0 else spread
    floor = REPLAY_RESOLUTION * (float(np.nanstd(measured)) or _largest(residual))
    return max(level, _rounding(lattice(measured), level), floor, 1e-300)


def typical_size(errors: Floats) -> float:
    """Standard deviation of normal errors (s,), which a few that are far off hardly move."""
    return 1.4826 * float(np.median(np.abs(errors)))


def fast_noise(values: Floats) -> float:
    """Standard deviation of white noise on values (s,) that are smooth beside it, from third differences."""
    return float(typical_size(np.diff(values, 3)) / np.sqrt(20.0))


def _tails(errors: Floats) -> float:
    """Standard deviation over the typical size of errors that are far off now and then in every part of a
    recording; 1 where they are not: what happens in some parts alone, or together, is no noise.
    """
    parts = np.array_split(errors, TAILS_PARTS)
    typical = np.array([typical_size(part) for part in parts])
    if parts[-1].size < TAILS_FEWEST_SAMPLES or not typical.all():
        return 1.0
    ratio = float(np.median([part.std() for part in parts] / typical))
    return min(ratio, TAILS_MOST) if ratio > TAILS_LEAST and not _come_together(errors) else 1.0


def _come_together(errors: Floats) -> bool:
    """Whether errors that are far off are followed by others more often than chance has it."""
    far = np.abs(errors) > TAIL_STDS * typical_size(errors)
    both = [float(np.mean(far[lag:] & far[:-lag])) for lag in TAIL_LAGS]
    return float(np.mean(both)) > TAILS_TOGETHER_RATIO * float(np.mean(far)) ** 2


def _largest(residual: Floats) -> float:
    """Largest error: the only scale of a channel that rests throughout."""
    known = residual[np.isfinite(residual)]
    return float(np.abs(known).max(initial=0.0))


def _rounding(step: float | None, level: float) -> float:
    """Noise that rounding to a lattice stands for, beside other noise of some level.

    Where that noise does not blur the steps, the errors repeat with the motion, as no white noise does, and
    data count for less.
    """
    if step is None:
        return 0.0
    return step if step > ROUNDING_STEP_TO_NOISE * level else step / np.sqrt(12.0)


def lattice(values: Floats) -> float | None:
    """Step of the lattice on which all values lie; None when they lie on none.

    Values with noise of their own, recorded as double numbers, lie on none that is coarser than rounding.
    """
    known = np.unique(values[np.isfinite(values)])
    if known.size < 3 or known.size > LATTICE_MOST_VALUES * np.count_nonzero(np.isfinite(values)):
        return None
    gaps = np.diff(known)
    gaps = gaps[gaps > 1e-9 * np.abs(known).max()]
    if not gaps.size:
        return None
    step = float(gaps.min())
    for _ in range(3):
        counts = np.rint(gaps / step)
        step = float(np.sum(gaps * counts) / np.sum(counts * counts))
    counts = np.rint(known / step)  # over the whole range the step is told best
    step = float(np.sum(known * counts) / np.sum(counts * counts))
    off = np.abs(known / step - counts)
    allowed = LATTICE_TOLERANCE + 1e-9 * np.abs(known).max() / step
    written = 0.5 * _last_digit(known) / step
    if written < LATTICE_LAST_DIGIT_SHARE:
        allowed += written
    return step if float(off.max()) < allowed else None


def _last_digit(values: Floats) -> float:
    """Value of the last decimal digit with which all values are written; 0 where they have more."""
    for digits in range(LATTICE_MOST_DIGITS):
        scaled = values * 10.0**digits
        if np.all(np.abs(scaled - np.rint(scaled)) < 1e-6):
            return float(10.0**-digits)
    return 0.0
