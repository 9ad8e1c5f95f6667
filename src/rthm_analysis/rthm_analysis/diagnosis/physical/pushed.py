"""A push that nobody recorded: a model follows the rig everywhere but for a moment."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    PUSH_APART_RATIO,
    PUSH_FEWEST_RUNS,
    PUSH_GOES_ON_RATIO,
    PUSH_LEFT_RATIO,
    PUSH_MOST_SHARE,
    PUSH_NARROW_LENGTH,
    PUSH_RATIO,
    PUSH_REST_CHI2,
    PUSH_ROUNDS,
    PUSH_RUN_LENGTHS,
)
from rthm_analysis.diagnosis.faults.moments import Moment
from rthm_analysis.diagnosis.physical.judged import (
    by_starts,
    by_values,
    over_noise,
    remainders,
    simulate_all,
)
from rthm_analysis.diagnosis.physical.push import push_of
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_analysis.diagnosis.result import Described
from rthm_core.compiled import Flags, Floats


class _Short(NamedTuple):
    """What a model leaves in short runs: of each, its samples, errors (b,), and what its start (b, q) and the
    values of the model (b, p) make of them, over the noise.
    """

    samples: list[slice]
    left: list[Floats]
    starts: list[Floats]
    values: list[Floats]


def pushed(physical: Physical) -> tuple[Moment, ...]:
    """The moments in which something pushed the plant, or its sensors showed another motion.

    In runs of a few periods, from the best start of each, one set of values of the retuned model leaves
    nothing but noise; only where the rig was pushed neither they nor others do. What only happens where the
    rig moves furthest is physics.
    """
    evidence, spec = physical.evidence, physical.selection.base.model.spec
    if evidence.has_several or _leaves_nothing(physical):
        return ()
    for longer in PUSH_RUN_LENGTHS:
        runs = windows(evidence, spec, evidence.driven_by == "command", longer, short=True)
        if runs.start.size < PUSH_FEWEST_RUNS:
            return ()
        if found := _pushed_in(physical, runs):
            return found
    return ()


def _leaves_nothing(physical: Physical) -> bool:
    """Whether the retuned model alone leaves nothing but noise anywhere."""
    if physical.selection.rounds:
        return False
    left = remainders(physical, simulate_all(physical, physical.selection.base).predicted)
    return not any(one.in_train or one.in_held_out or one.parts.size for one in left)


def _pushed_in(physical: Physical, runs: Windows) -> tuple[Moment, ...]:
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
    alike = most < max(PUSH_REST_CHI2, PUSH_RATIO * float(np.median(rest[~off])))
    apart = float(np.min(rest[off])) > PUSH_APART_RATIO * most
    if not (apart or (alike and float(np.max(rest[off])) > PUSH_LEFT_RATIO * most)):
        return ()
    parts = np.flatnonzero(np.diff(off, prepend=False, append=False)).reshape(-1, 2).tolist()
    spans = _narrowed(physical, values, [_span(physical, runs, *part) for part in parts])
    allowed = PUSH_GOES_ON_RATIO * most
    return tuple(
        Moment(*span, _push(physical, runs, values, (first, behind), span, allowed))
        for (first, behind), span in zip(parts, spans, strict=True)
    )


def _span(physical: Physical, runs: Windows, first: int, behind: int) -> tuple[float, float]:
    """Begin and end of some runs, s."""
    time = physical.evidence.time
    end = time[runs.start[behind]] if behind < runs.start.size else time[-1]
    return float(time[runs.start[first]]), float(end)


def _narrowed(
    physical: Physical, values: Floats, spans: list[tuple[float, float]]
) -> list[tuple[float, float]]:
    """The parts of some spans in which runs of a part of a period leave more than elsewhere, if any do."""
    evidence, spec = physical.evidence, physical.selection.base.model.spec
    runs = windows(evidence, spec, evidence.driven_by == "command", PUSH_NARROW_LENGTH, short=True)
    short = _short(physical, runs, values)
    if short is None:
        return spans
    left = _of_starts(short)
    off = np.flatnonzero(left > PUSH_RATIO * float(np.median(left)))
    fine = [_span(physical, runs, int(one), int(one) + 1) for one in off]
    found = []
    for begin, end in spans:
        inside = [one for one in fine if one[0] < end and one[1] > begin]
        narrow = (inside[0][0], inside[-1][1]) if inside else (begin, end)
        found.append((max(begin, narrow[0]), min(end, narrow[1])))
    return found


def _of_starts(short: _Short) -> Floats:
    """Reduced chi-squared (r,) of each run from its best start."""
    return np.array([_chi2(*one) for one in zip(short.left, short.starts, strict=True)])


def _push(
    physical: Physical,
    runs: Windows,
    values: Floats,
    off: tuple[int, int],
    span: tuple[float, float],
    allowed: float,
) -> Described | None:
    """What pushed the plant in some runs; None where the motion behind them is that before them, so that only
    what was recorded was off.
    """
    first, behind = off
    kept = np.delete(np.arange(runs.start.size), slice(max(first, 1), behind + 1))
    through = Windows(runs.start[kept], runs.state[kept], runs.length)
    if first > 0 and behind < runs.start.size:
        merged = _short(physical, through, values)
        if merged is None:
            return push_of(physical, through, values, span)
        part = merged.samples[first - 1]
        width = merged.left[first - 1].size // (part.stop - part.start)
        before, until = (int(runs.start[one] - part.start) * width for one in off)
        rows = np.delete(np.arange(merged.left[first - 1].size), slice(before, until))
        if _chi2(merged.left[first - 1][rows], merged.starts[first - 1][rows]) < allowed:
            return None
    return push_of(physical, through, values, span)


def _short(physical: Physical, runs: Windows, values: Floats) -> _Short | None:
    """What the retuned model with some values leaves in short runs; None where it diverges."""
    evidence, model = physical.evidence, physical.selection.base.model.at(values)
    experiment = physical.experiment.beginning_at(evidence.stamps_ns[runs.start])
    predicted = experiment.predicted(model.spec, runs)
    left = over_noise(physical, (evidence.measured - predicted)[:, :, None])[:, :, 0]
    shapes = [
        over_noise(physical, one)
        for one in (
            by_starts(experiment, model.spec, runs, predicted),
            by_values(experiment, model, runs, predicted),
        )
    ]
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
