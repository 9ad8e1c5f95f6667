"""When something is missing."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import LARGEST_INTERVAL_SHARE
from rthm_analysis.diagnosis.physical.verdict import Judgement


def when(judged: Judgement) -> tuple[float, float] | None:
    """Interval in s in which the recording differs; None: throughout, or where nobody can tell."""
    physical = judged.physical
    parts = [one.parts for one in judged.left_over if one.parts.size]
    if not parts:
        return None
    rows = np.concatenate(parts)
    begin, end = int(rows[:, 0].min()), int(rows[:, 1].max())
    if end - begin > LARGEST_INTERVAL_SHARE * physical.evidence.time.size:
        return None
    time = physical.evidence.time
    return float(time[begin]), float(time[min(end, time.size - 1)])
