"""A push that nobody recorded: a model follows the rig everywhere but for a moment."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import (
    PUSH_APART_RATIO,
    PUSH_FEWEST_RUNS,
    PUSH_GOES_ON_RATIO,
    PUSH_LEFT_RATIO,
    PUSH_LONGEST_PERIODS,
    PUSH_MOST_SHARE,
    PUSH_NARROW_LENGTH,
    PUSH_RATIO,
    PUSH_REST_CHI2,
    PUSH_ROUNDS,
    PUSH_RUN_LENGTHS,
)
from rthm_analysis.diagnosis.faults.moments import Moment
from rthm_analysis.diagnosis.physical.judged import remainders, simulate_all
from rthm_analysis.diagnosis.physical.push import push_of
from rthm_analysis.diagnosis.physical.run_by_run import RunByRun, run_by_run
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_core.compiled import Flags, Floats


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
    compared = run_by_run(physical, runs, model.values)
    if compared is None:
        return ()
    by_itself = compared.from_best_values()
    off = by_itself > PUSH_RATIO * float(np.median(by_itself))
    if not 0.0 < off.mean() <= PUSH_MOST_SHARE or _is_furthest(physical, compared, off):
        return ()
    values = model.values
    for _ in range(PUSH_ROUNDS):
        values = model.at(values + compared.step(~off)).values
        compared = run_by_run(physical, runs, values)
        if compared is None:
            return ()
    left = compared.from_best_starts()
    if not _is_apart(left[off], left[~off]):
        return ()
    parts = np.flatnonzero(np.diff(off, prepend=False, append=False)).reshape(-1, 2).tolist()
    spans = _narrowed(physical, values, [_span(physical, runs, *part) for part in parts])
    if max(end - begin for begin, end in spans) > PUSH_LONGEST_PERIODS * physical.evidence.period:
        return ()
    allowed = PUSH_GOES_ON_RATIO * float(np.max(left[~off]))
    return tuple(
        _moment(physical, runs, values, (first, behind), span, allowed)
        for (first, behind), span in zip(parts, spans, strict=True)
    )


def _is_apart(off: Floats, others: Floats) -> bool:
    """Whether what some runs leave is of another size than what all others leave, which are alike."""
    most = float(np.max(others))
    alike = most < max(PUSH_REST_CHI2, PUSH_RATIO * float(np.median(others)))
    if float(np.min(off)) > PUSH_APART_RATIO * most:
        return True
    return alike and float(np.max(off)) > PUSH_LEFT_RATIO * most


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
    compared = run_by_run(physical, runs, values)
    if compared is None:
        return spans
    left = compared.from_best_starts()
    off = np.flatnonzero(left > PUSH_RATIO * float(np.median(left)))
    fine = [_span(physical, runs, int(one), int(one) + 1) for one in off]
    found = []
    for begin, end in spans:
        inside = [one for one in fine if one[0] < end and one[1] > begin]
        narrow = (inside[0][0], inside[-1][1]) if inside else (begin, end)
        found.append((max(begin, narrow[0]), min(end, narrow[1])))
    return found


def _moment(
    physical: Physical,
    runs: Windows,
    values: Floats,
    off: tuple[int, int],
    span: tuple[float, float],
    allowed: float,
) -> Moment:
    """What happened in some runs: a push, unless the motion behind them is that before them, so that only
    sensors were off.
    """
    first, behind = off
    kept = np.delete(np.arange(runs.start.size), slice(max(first, 1), behind + 1))
    through = Windows(runs.start[kept], runs.state[kept], runs.length)
    compared = run_by_run(physical, through, values)
    if compared is not None and first > 0 and behind < runs.start.size:
        begin = compared.samples[first - 1].start
        gap = slice(int(runs.start[first]) - begin, int(runs.start[behind]) - begin)
        around, inside = compared.through(first - 1, gap)
        if around < allowed:
            channels = zip(physical.evidence.channels, inside, strict=True)
            return Moment(*span, strayed=tuple(one for one, left in channels if left > allowed))
    return Moment(*span, push_of(physical, through, values, span))


def _is_furthest(physical: Physical, compared: RunByRun, off: Flags) -> bool:
    """Whether a signal goes further in the runs that are off than in all others."""
    measured = physical.evidence.measured
    sizes = np.array([np.nanmax(np.abs(measured[part]), axis=0) for part in compared.samples])
    return bool(np.any(np.nanmax(sizes[off], axis=0) > np.nanmax(sizes[~off], axis=0)))
