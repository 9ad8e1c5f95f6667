"""What happened between two samples of a load: the recording does not say, and it matters more than noise."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence


class Between(Enum):
    """How a load that is known by its samples goes between them; the values complete a sentence."""

    SMOOTH = "follows a smooth curve"
    LINEAR = "follows a straight line"
    HELD = "is held"


def ways(evidence: Evidence) -> tuple[Between, ...]:
    """What has to be tried: all where the loads of a plant are known by their samples alone."""
    sampled = evidence.driven_by == "force" and bool(np.any(evidence.load))
    return tuple(Between) if sampled else (Between.SMOOTH,)
