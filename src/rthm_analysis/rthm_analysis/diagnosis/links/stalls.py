"""Samples whose fate a stalled host decided, where no times of sending tell when it stalled.

While a process or a network stands still, several samples in a row fail to arrive, and come all at once
afterwards, in any order. Losses and jitter, drawn anew for every sample, do that as rarely as chance has it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import (
    STALL_LATE,
    STALL_MISSING_SAMPLES,
    STALL_MOST_SHARE,
    STALL_RATIO_TO_CHANCE,
)

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers


def stalled_at_ticks(due: Integers, at: Integers, row: Integers) -> Integers:
    """Samples that were passed over in stalls, where the receiver is on a clock.

    Parameters
    ----------
    due : (n,) array
        When the samples are nominally due, ns.
    at, row : (u,) arrays
        Ticks, ns, and the sample used at each.
    """
    newest = np.searchsorted(due, at, side="right") - 1
    missing = np.maximum(newest - row, 0)
    several, any_at_all = np.mean(missing >= STALL_MISSING_SAMPLES), np.mean(missing >= 1)
    if several <= STALL_RATIO_TO_CHANCE * any_at_all**STALL_MISSING_SAMPLES or several > STALL_MOST_SHARE:
        return np.empty(0, dtype=np.int64)
    episode = np.cumsum(np.diff(missing > 0, prepend=False) != 0)
    deepest = np.zeros(int(episode[-1]) + 1, dtype=np.int64)
    np.maximum.at(deepest, episode, missing)
    stalled = np.flatnonzero((deepest[episode] >= STALL_MISSING_SAMPLES) & (missing > 0))
    passed = [np.arange(row[k] + 1, newest[k] + 1) for k in stalled]
    return np.unique(np.concatenate(passed)) if passed else np.empty(0, dtype=np.int64)


def overtaken_after_stalls(high: Floats, row: Integers) -> Integers:
    """Samples that were overtaken when a stall ended, where the receiver uses samples as they come.

    Parameters
    ----------
    high : (n,) array
        Extra delay of the samples that were used, s; infinite for others.
    row : (u,) array
        Samples used, in the order of their uses.
    """
    unused = np.flatnonzero(np.isinf(high))
    newer = np.searchsorted(row, unused)
    unused, newer = unused[newer < row.size], newer[newer < row.size]
    overtaken = unused[high[row[newer]] > STALL_LATE]
    return overtaken if overtaken.size <= STALL_MOST_SHARE * high.size else np.empty(0, dtype=np.int64)
