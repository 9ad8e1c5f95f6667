"""The smallest effects on a link that its uses would have shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import LINK_DETECTION_GAIN, LINK_DETECTION_RANGES, USE_GRAIN
from rthm_analysis.diagnosis.links.models import Model

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.links.evidence import LinkEvidence
    from rthm_core.compiled import Floats


EDGES = np.concatenate([[-np.inf], np.geomspace(USE_GRAIN / 2, 1.0, 90), [np.inf]])


def smallest(evidence: LinkEvidence, nothing: Model, kind: str, allowance: float) -> float:
    """Smallest delay or spread of it (s) or part lost (1) that would have been told from `nothing`.

    Parameters
    ----------
    allowance : float
        Delay or spread below which the lateness of the machine is the better explanation.
    """
    slack, count = _slack(evidence)
    low, high = LINK_DETECTION_RANGES[kind]
    for _ in range(20):
        middle = float(np.sqrt(low * high))
        other = nothing.but(**{kind: middle})
        if _information(evidence, slack, count, other, nothing) > LINK_DETECTION_GAIN:
            high = middle
        else:
            low = middle
    return max(high, allowance) if kind != "lost" else high


def _slack(evidence: LinkEvidence) -> tuple[Floats, Floats]:
    """How long before a tick the newest sample was due (s), and how often."""
    newest = np.searchsorted(evidence.due, evidence.use_ns, side="right") - 1
    known = newest >= 0
    slack = (evidence.use_ns[known] - evidence.due[newest[known]]) * 1e-9
    binned, count = np.unique(np.rint(slack / 1e-5), return_counts=True)
    return binned * 1e-5, count.astype(float)


def _information(evidence: LinkEvidence, slack: Floats, count: Floats, true: Model, other: Model) -> float:
    """Expected gain of `true` over `other` in the logarithm of the likelihood, if `true` holds."""
    if not evidence.clocked:
        p, q = (model.probability(EDGES[:-1], EDGES[1:]) for model in (true, other))
        return evidence.use_ns.size * float(np.sum(p * np.log(p / q)))
    here = np.full(slack.size, -np.inf)
    arrived, expected = (model.probability(here, slack) for model in (true, other))
    absent, unexpected = (np.maximum(1.0 - value, 1e-12) for value in (arrived, expected))
    gain = arrived * np.log(arrived / expected) + absent * np.log(absent / unexpected)
    return float(count @ gain)
