"""What commands ask motor and wire to do: a jump that was commanded is no fault of the sensor that
shows it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.faults.stretches import Stretch
from rthm_analysis.diagnosis.replay.evidence import Evidence

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

PASSED_ON = 0.025
"""Seconds by which a jump of a command may come before its traces in motor and force."""

LIVELY = 3.0
"""Change of a command over such a time, over the usual one, that may make the force jump."""


def told_to(evidence: Evidence, column: int, one: Stretch) -> bool:
    """Whether commands explain that motor or force jump where a stretch begins or ends.

    Positions and velocities of the plant never jump because of a command.
    """
    channel = evidence.channels[column]
    if channel.family not in ("force", "motor") or not evidence.commands.size:
        return False
    return any(_changed(evidence, at) for at in one)


def _changed(evidence: Evidence, sample: int) -> bool:
    """Whether a command changed unusually much just before a sample."""
    stamps, due = evidence.stamps_ns, evidence.due_ns
    now = int(stamps[min(sample, stamps.size - 1)])
    reach = int(PASSED_ON * 1e9)
    first, last = np.searchsorted(due, [now - reach, now + int(np.median(np.diff(stamps)))], side="right")
    many = max(int(last - first), 1)
    return any(
        _range(column, int(first) - 1, int(last)) > LIVELY * _usual(column, many)
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
