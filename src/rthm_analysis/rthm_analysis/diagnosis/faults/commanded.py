"""What the rig was told to do, or does: a jump that was commanded, or a rest, is no fault of the sensor
that shows it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import COMMAND_TRACE_S, LIVELY_COMMAND_RATIO, STILL_TRAVEL_RATIO
from rthm_analysis.diagnosis.faults.stretches import Stretch
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.signals import filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


def told_to(evidence: Evidence, column: int, one: Stretch) -> bool:
    """Whether commands explain that motor or force jump where a stretch begins or ends.

    The motion of the plant never jumps because of a command.
    """
    channel = evidence.channels[column]
    if channel.family not in ("force", "motor") or not evidence.commands.size:
        return False
    return any(_changed(evidence, at) for at in one)


def is_real(evidence: Evidence, column: int, one: Stretch) -> bool:
    """Whether zeros may be true: commanded, or of rates whose position stands still, or is not known."""
    channel = evidence.channels[column]
    position = Channel("position", channel.place)
    if channel.family not in ("velocity", "acceleration"):
        return told_to(evidence, column, one)
    if position not in evidence.channels:
        return True
    x, (begin, end) = filled(evidence.measured[:, evidence.channels.index(position)]), one
    beside = x[max(2 * begin - end, 0) : begin], x[end : 2 * end - begin]
    moved = max(float(np.ptp(side)) if side.size else 0.0 for side in beside)
    return bool(np.ptp(x[begin:end]) <= STILL_TRAVEL_RATIO * moved)


def _changed(evidence: Evidence, sample: int) -> bool:
    """Whether a command changed unusually much just before a sample."""
    stamps, due = evidence.stamps_ns, evidence.due_ns
    now = int(stamps[min(sample, stamps.size - 1)])
    reach = int(COMMAND_TRACE_S * 1e9)
    first, last = np.searchsorted(due, [now - reach, now + int(np.median(np.diff(stamps)))], side="right")
    many = max(int(last - first), 1)
    return any(
        _range(column, int(first) - 1, int(last)) > LIVELY_COMMAND_RATIO * _usual(column, many)
        for column in evidence.commands.T
    )


def _range(values: Floats, first: int, last: int) -> float:
    part = values[max(first, 0) : last]
    return float(np.ptp(part)) if part.size else 0.0


def _usual(values: Floats, many: int) -> float:
    """Median change over so many commands."""
    if values.size <= many:
        return float(np.ptp(values)) if values.size else 0.0
    return float(np.median(np.abs(values[many:] - values[:-many])))
