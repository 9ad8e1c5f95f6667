"""States in which free runs start, from whole periods of each.

Where the velocity is not measured, a parabola through a few positions leaves more of it open than a law that
is not linear forgives.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import (
    START_LEAST_SHARE,
    START_LEFT_RATIO,
    START_PERIODS,
    START_ROUNDS,
    START_STEP,
)
from rthm_analysis.diagnosis.replay.experiment import Experiment

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_analysis.diagnosis.replay.windows import Windows
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def refined(evidence: Evidence, spec: Spec, runs: Windows, period: float, *, bent: bool = False) -> Windows:
    """Runs of a plant under known forces that start where ever more of their first periods (s) fit best.

    A run of which the spec leaves more than noise there starts where it did, unless it may be `bent` to it.
    """
    n = runs.state.shape[1] // 2
    size = (float(np.nanstd(evidence.measured[:, 0])) or 1.0) * np.repeat([1.0, 2.0 * np.pi / period], n)
    for periods in START_PERIODS:
        runs = _fitted(evidence, spec, runs, _beginnings(evidence, runs, periods * period), size, bent)
    return runs


def _fitted(
    evidence: Evidence, spec: Spec, runs: Windows, parts: list[slice], size: Floats, bent: bool
) -> Windows:
    """Runs that start where their beginnings fit best, states having sizes (2 n,)."""
    seen, better = evidence.first(parts[-1].stop), runs
    experiment = Experiment(seen, np.empty(0), evidence.stamps_ns[runs.start])
    for _ in range(START_ROUNDS):
        better = _nearer(experiment, spec, better, parts, size)
    left = seen.measured - experiment.predicted(spec, better)
    before = seen.measured - experiment.predicted(spec, runs) if bent else left
    near = np.array([_is_noise(left[one]) or (bent and _is_less(left[one], before[one])) for one in parts])
    return runs.at(np.where(near[:, None], better.state, runs.state))


def _beginnings(evidence: Evidence, runs: Windows, length: float) -> list[slice]:
    """Samples of the first `length` seconds of each run; none is unseen where the run begins before these."""
    ends = np.append(runs.start[1:], evidence.stamps_ns.size)
    ends = np.where(runs.start < evidence.trained, np.minimum(ends, evidence.trained), ends)
    until = np.searchsorted(evidence.time, evidence.time[runs.start] + length)
    return [slice(a, max(a + 1, min(b, c))) for a, b, c in zip(runs.start, ends, until, strict=True)]


def _nearer(experiment: Experiment, spec: Spec, runs: Windows, parts: list[slice], size: Floats) -> Windows:
    """One step of Gauss and Newton for the state in which each run starts."""
    base = experiment.predicted(spec, runs)
    left, steps = experiment.evidence.measured - base, START_STEP * size
    moved = [experiment.predicted(spec, runs.moved(j, step)) - base for j, step in enumerate(steps)]
    columns = np.stack(moved, axis=-1) / START_STEP
    return runs.at(runs.state + size * np.array([_solved(left[part], columns[part]) for part in parts]))


def _solved(left: Floats, columns: Floats) -> Floats:
    """Change of a state (2 n,), in its size, that leaves least of the errors (s, k) over their noise.

    None where it hardly shows: a dof that sticks forgets its velocity.
    """
    noise = _noise(left)
    weight = 1.0 / np.where(noise > 0.0, noise, 1.0)
    known = np.isfinite(left) & np.isfinite(columns).all(axis=-1)
    rows = (columns * weight[:, None])[known]
    if known.sum() < rows.shape[1]:
        return np.zeros(rows.shape[1])
    return np.asarray(np.linalg.lstsq(rows, (left * weight)[known], rcond=START_LEAST_SHARE)[0])


def _noise(left: Floats) -> Floats:
    """White noise (k,) of some errors, from sample to sample."""
    return np.asarray(np.sqrt(0.5 * _mean_square(np.diff(left, axis=0))))


def _is_noise(left: Floats) -> bool:
    """Whether errors are no larger than what they change by from sample to sample."""
    return bool(np.all(_mean_square(left) <= START_LEFT_RATIO**2 * _noise(left) ** 2))


def _is_less(left: Floats, before: Floats) -> bool:
    return bool(np.nansum(left**2) < np.nansum(before**2))


def _mean_square(values: Floats) -> Floats:
    """Mean square (k,) of what is known of some values (s, k)."""
    count = np.isfinite(values).sum(axis=0)
    return np.asarray(np.nansum(values**2, axis=0) / np.maximum(count, 1))
