"""How old the sample is that a receiver holds, as recorded and as a model of the link expects it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import DEEPEST_HELD_SAMPLES, LOOKS_PER_PERIOD
from rthm_analysis.timing.host_stalls import stalled_between
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.links.evidence import LinkEvidence
    from rthm_analysis.diagnosis.links.models import Model
    from rthm_core.compiled import Floats, Integers


GOLDEN: float = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class Ages:
    """Age of the sample in use at some instants.

    Attributes
    ----------
    at : (n,) array
        Instants, ns after the start: ticks of the receiver, or points of a grid.
    age : (n,) array
        Instant minus the stamp of the sample in use, s.
    """

    at: Integers
    age: Floats


def ages(evidence: LinkEvidence, begin_ns: int, end_ns: int) -> Ages:
    """Ages in a span of time, as recorded; none where the newest sample came while a host stalled."""
    first = int(evidence.use_ns[0])
    if evidence.clocked:
        at = evidence.use_ns[(evidence.use_ns >= begin_ns) & (evidence.use_ns < end_ns)]
    else:
        last = min(end_ns, int(evidence.use_ns[-1]) + 1)
        at = _scattered(max(begin_ns, first), last, max(evidence.period_ns // LOOKS_PER_PERIOD, 1))
    newest = np.maximum(np.searchsorted(evidence.due, at, side="right") - 1, 0)
    at = at[~stalled_between(evidence.host_stalls, evidence.stamp[newest] - evidence.offset_ns, at)]
    use = np.searchsorted(evidence.use_ns, at, side="right") - 1
    return Ages(at, (at - evidence.stamp[evidence.row[use]]) / NS)


def expected(evidence: LinkEvidence, model: Model, at: Integers) -> tuple[Floats, Floats]:
    """Mean and standard deviation of the age at the instants `at` when extra delays follow `model`, s."""
    early = int(min(model.delay, 0.0) * NS)
    newest = np.searchsorted(evidence.due + early, at, side="right") - 1
    missing = np.ones(at.size)
    mean, square = np.zeros(at.size), np.zeros(at.size)
    for back in range(DEEPEST_HELD_SAMPLES):
        row = np.maximum(newest - back, 0)
        arrived = (1.0 - model.lost) * model.arrived((at - evidence.due[row]) / NS)
        if back == DEEPEST_HELD_SAMPLES - 1:
            arrived = np.ones(at.size)
        age = (at - evidence.stamp[row]) / NS
        mean += missing * arrived * age
        square += missing * arrived * age**2
        missing = missing * (1.0 - arrived)
        if missing.max(initial=0.0) < 1e-9:
            break
    return mean, np.sqrt(np.maximum(square - mean**2, 0.0))


def _scattered(begin: int, end: int, step: int) -> Integers:
    """One instant in each of many steps, at any place within it, so that no period is always met alike."""
    number = np.arange(max((end - begin) // step, 0), dtype=np.int64)
    return begin + number * step + (number * GOLDEN % 1.0 * step).astype(np.int64)
