"""Errors that nothing in the rig foretells: noise of a sensor, however loud it is and slowly it wanders."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import (
    CAUSE_LEAST_EIGENVALUE,
    CAUSE_LEVELS,
    CAUSE_SHARE,
    CAUSE_SHIFTS,
    CAUSE_STRETCHES,
    DRIFT_LEFT_SHARE,
    EVENT_POWER_RATIO,
    RARE_MEDIAN_SHARE,
)
from rthm_analysis.diagnosis.faults.stretches import held_commands
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_core.compiled import Flags, Floats, Integers


def possible_causes(evidence: Evidence, predicted: Floats) -> list[Floats]:
    """What may have caused an error: motion and forces that a model predicts (s, k), loads, commands."""
    causes = [np.nan_to_num(one) for one in (*predicted.T, *evidence.load.T)]
    return causes + list(held_commands(evidence).T) if evidence.driven_by == "command" else causes


def unrelated(error: Floats, causes: Sequence[Floats]) -> bool:
    """Whether an error is equally large throughout, follows no line, and nothing that might have caused it
    foretells it.

    Parameters
    ----------
    error : (s,) array
        Measured minus simulated; NaN where nothing was measured.
    causes : sequence of (s,) arrays
        Commands, loads, and the motion and forces that a model predicts.
    """
    blocks: Integers = np.arange(error.size) * CAUSE_STRETCHES // error.size
    known = np.isfinite(error)
    error = np.where(known, error - np.nanmean(error), 0.0)
    power = np.bincount(blocks, np.square(error)) / np.maximum(np.bincount(blocks, known), 1)
    whole = float(np.square(error).sum())
    if (
        power.max() > EVENT_POWER_RATIO * float(np.median(power))
        or is_rare(error[known])
        or _drifts(error[known])
    ):
        return False
    return not any(
        _missed(_parts(cause, known), error, blocks) < (1.0 - CAUSE_SHARE) * whole for cause in causes
    )


def is_rare(error: Floats) -> bool:
    """Whether a few samples hold nearly all of an error (s,): no noise does that."""
    squares = np.square(error - np.median(error))
    return bool(np.median(squares) < RARE_MEDIAN_SHARE * np.mean(squares))


def _drifts(error: Floats) -> bool:
    """Whether a line over time is more than half of an error (s,)."""
    at = np.arange(error.size)
    straight = np.polyval(np.polyfit(at, error, 1), at)
    return float(np.square(error - straight).sum()) < DRIFT_LEFT_SHARE * float(np.square(error).sum())


def _missed(parts: Callable[[slice], Floats], error: Floats, blocks: Integers) -> float:
    """Squared error (s,) that parts do not foretell, every second block (s,) by those between."""
    edges = np.searchsorted(blocks, np.arange(CAUSE_STRETCHES + 1))
    normal: list[Any] = [0.0, 0.0]
    moment: list[Any] = [0.0, 0.0]
    for block, ends in enumerate(pairwise(edges.tolist())):
        here = parts(slice(*ends))
        normal[block % 2] += here @ here.T
        moment[block % 2] += here @ error[slice(*ends)]
    missed = float(error @ error)
    for these, others in ((0, 1), (1, 0)):
        sizes = _solved(normal[others], moment[others])
        missed += float(sizes @ normal[these] @ sizes - 2.0 * sizes @ moment[these])
    return missed


def _solved(normal: Floats, moment: Floats) -> Floats:
    """Sizes (p,) by normal equations; what tells parts apart by rounding alone counts for nothing."""
    values, vectors = np.linalg.eigh(normal)
    kept = values > CAUSE_LEAST_EIGENVALUE * values[-1]
    return np.asarray(vectors[:, kept] @ (vectors[:, kept].T @ moment / values[kept]))


def _parts(cause: Floats, known: Flags) -> Callable[[slice], Floats]:
    """What a cause (s,) may make of some samples (p, b), where they are known: it itself around each, and
    curves over it and its change. Of all samples at once it would be large.
    """
    change = cause - np.roll(cause, max(CAUSE_SHIFTS))
    levels = [_level(cause), _level(change)]

    def of(samples: slice) -> Floats:
        at = np.arange(cause.size)[samples]
        shifted = [cause[(at - shift) % cause.size] for shift in CAUSE_SHIFTS]
        steps = [level[samples] == np.arange(1, CAUSE_LEVELS)[:, None] for level in levels]
        return np.vstack([np.ones(at.size), *shifted, *steps]) * known[samples]

    return of


def _level(values: Floats) -> Integers:
    """Level (s,) of a signal, each met equally often."""
    edges = np.quantile(values, np.linspace(0.0, 1.0, CAUSE_LEVELS + 1)[1:-1])
    return np.searchsorted(edges, values)
