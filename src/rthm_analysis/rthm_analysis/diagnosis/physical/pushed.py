"""A push that nobody recorded: a model follows the rig everywhere but for a moment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    PUSH_FEWEST_RUNS,
    PUSH_GOES_ON_RATIO,
    PUSH_LEFT_RATIO,
    PUSH_MOST_SHARE,
    PUSH_RATIO,
    PUSH_REST_CHI2,
    PUSH_ROUNDS,
    PUSH_RUN_LENGTHS,
)
from rthm_analysis.diagnosis.faults.push import Push
from rthm_analysis.diagnosis.physical.judged import by_starts, by_values
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_core.compiled import Flags, Floats


class _Short(NamedTuple):
    """What a model leaves in short runs: of each, its samples, errors (b,), and what its start (b, q) and the
    values of the model (b, p) make of them, over the noise.
    """

    samples: list[slice]
    left: list[Floats]
    starts: list[Floats]
    values: list[Floats]


def pushed(physical: Physical) -> tuple[Push, ...]:
    """The moments in which something pushed a plant under known forces, or its sensors showed another
    motion.

    In runs of a few periods, from the best start of each, one set of values of the retuned model leaves
    nothing but noise; only where the rig was pushed neither they nor others do. What only happens where the
    rig moves furthest is physics.
    """
    evidence = physical.evidence
    if evidence.driven_by != "force" or len(evidence.recordings) > 1:
        return ()
    spec = physical.selection.base.model.spec
    for longer in PUSH_RUN_LENGTHS:
        runs = windows(evidence, spec, known_start=False, longer=longer, short=True)
        if runs.start.size < PUSH_FEWEST_RUNS:
            return ()
        if found := _pushed_in(physical, runs):
            return found
    return ()


def _pushed_in(physical: Physical, runs: Windows) -> tuple[Push, ...]:
    model = physical.selection.base.model
    short = _short(physical, runs, model.values)
    if short is None:
        return ()
    by_itself = np.array([_chi2(*one) for one in zip(short.left, short.starts, short.values, strict=True)])
    off = by_itself > PUSH_RATIO * float(np.median(by_itself))
    if not 0.0 < off.mean() <= PUSH_MOST_SHARE or _is_furthest(physical, short, off):
        return ()
    values = model.values
    for _ in range(PUSH_ROUNDS):
        values = model.at(values + _step(short, ~off)).values
        short = _short(physical, runs, values)
        if short is None:
            return ()
    rest = _of_starts(short)
    most = float(np.max(rest[~off]))
    if most > PUSH_REST_CHI2 or float(np.min(rest[off])) < PUSH_LEFT_RATIO * most:
        return ()
    moments = np.flatnonzero(np.diff(off, prepend=False, append=False)).reshape(-1, 2).tolist()
    return tuple(
        Push(
            int(short.samples[first].start),
            int(short.samples[behind - 1].stop),
            _goes_on(physical, runs, values, (first, behind), PUSH_GOES_ON_RATIO * most),
        )
        for first, behind in moments
    )


def _of_starts(short: _Short) -> Floats:
    """Reduced chi-squared (r,) of each run from its best start."""
    return np.array([_chi2(*one) for one in zip(short.left, short.starts, strict=True)])


def _goes_on(physical: Physical, runs: Windows, values: Floats, off: tuple[int, int], allowed: float) -> bool:
    """Whether the motion behind some runs is that before them, so that only what was recorded was off."""
    first, behind = off
    if first == 0 or behind == runs.start.size:
        return False
    kept = np.delete(np.arange(runs.start.size), slice(first, behind + 1))
    merged = _short(physical, Windows(runs.start[kept], runs.state[kept], runs.length), values)
    if merged is None:
        return False
    left, starts = merged.left[first - 1], merged.starts[first - 1]
    width = left.size // (merged.samples[first - 1].stop - merged.samples[first - 1].start)
    before, until = (int(runs.start[one] - runs.start[first - 1]) * width for one in off)
    rows = np.delete(np.arange(left.size), slice(before, until))
    return _chi2(left[rows], starts[rows]) < allowed


def _short(physical: Physical, runs: Windows, values: Floats) -> _Short | None:
    """What the retuned model with some values leaves in short runs; None where it diverges."""
    evidence, model = physical.evidence, physical.selection.base.model.at(values)
    experiment = physical.experiment.beginning_at(evidence.stamps_ns[runs.start])
    predicted = experiment.predicted(model.spec, runs)
    known = np.isfinite(evidence.measured)
    level = physical.noise.level
    left = np.where(known, (evidence.measured - predicted) / level, 0.0)
    starts = by_starts(experiment, model.spec, runs, predicted)
    moved = by_values(experiment, model, runs, predicted)
    shapes = [np.where(known[:, :, None], one / level[:, None], 0.0) for one in (starts, moved)]
    if not all(np.isfinite(one).all() for one in (left, *shapes)):
        return None
    samples = [
        slice(*ends) for ends in zip(runs.start, np.append(runs.start[1:], left.shape[0]), strict=True)
    ]
    flat = [[one[part].reshape(left[part].size, -1) for part in samples] for one in shapes]
    return _Short(samples, [left[part].ravel() for part in samples], *flat)


def _without(shapes: Floats, values: Floats) -> Floats:
    """What shapes (b, q) cannot explain of values (b,) or (b, p)."""
    return np.asarray(values - shapes @ np.linalg.lstsq(shapes, values, rcond=1e-10)[0])


def _chi2(left: Floats, *shapes: Floats) -> float:
    """Mean square of what shapes cannot explain of errors over the noise."""
    columns = np.hstack(shapes)
    free = max(left.size - columns.shape[1], 1)
    return float(np.square(_without(columns, left)).sum() / free)


def _step(short: _Short, kept: Flags) -> Floats:
    """Change of the model's values that leaves least in some of the runs, from the best start of each."""
    rows = [i for i in range(kept.size) if kept[i]]
    values = np.vstack([_without(short.starts[i], short.values[i]) for i in rows])
    left = np.concatenate([_without(short.starts[i], short.left[i]) for i in rows])
    return np.asarray(np.linalg.lstsq(values, left, rcond=1e-10)[0])


def _is_furthest(physical: Physical, short: _Short, off: Flags) -> bool:
    """Whether a signal goes further in the runs that are off than in all others."""
    sizes = np.array([np.nanmax(np.abs(physical.evidence.measured[part]), axis=0) for part in short.samples])
    return bool(np.any(np.nanmax(sizes[off], axis=0) > np.nanmax(sizes[~off], axis=0)))
