"""Stretches in which nothing came through a link, though samples were sent and the receiver looked for them.

Losses are drawn anew for every sample; a cable that is out, a switch that starts again or a wireless link
takes many in a row, and the loop goes on with what it had.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import (
    OUTAGE_LOOKED_SHARE,
    OUTAGE_PERIODS,
    OUTAGE_TO_USUAL,
    STALL_LATE,
)
from rthm_analysis.diagnosis.numbers import instants
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.timing.links import SOURCES
from rthm_core.clock import NS
from rthm_core.topics import link_topic

if TYPE_CHECKING:
    from rthm_core.compiled import Integers


def outages(due: Integers, at: Integers, row: Integers, tick: int) -> Integers:
    """First sample that an outage took, and the first one after it, as rows (k, 2).

    Parameters
    ----------
    due : (n,) array
        When the samples are nominally due, ns.
    at, row : (u,) arrays
        Instants of use, ns, and the sample in use from then on.
    tick : int
        Period at which the receiver looks, ns; 0: it uses samples as they come.

    Examples
    --------
    >>> due = np.arange(100) * 10
    >>> outages(due, due, np.where((due > 300) & (due < 500), 30, np.arange(100)), 10)
    array([[31, 50]])
    """
    new = np.flatnonzero(np.diff(row) > 0)
    before, after, until = row[new], row[new + 1], at[new + 1]
    if tick and row[-1] + 1 < due.size:
        before, after, until = (
            np.append(before, row[-1]),
            np.append(after, due.size),
            np.append(until, at[-1]),
        )
    first = np.minimum(before + 1, due.size - 1)
    late = until - due[first]
    looked = np.searchsorted(at, until) - np.searchsorted(at, due[first])
    period = max(int(np.median(np.diff(due))), tick)
    usual = OUTAGE_TO_USUAL * float(np.quantile(np.diff(row)[new], 0.99)) if new.size else 1.0
    out = (after - before > usual) & (late > OUTAGE_PERIODS * period)
    if tick:
        out &= looked * tick > OUTAGE_LOOKED_SHARE * late
    else:
        out &= (after - before > OUTAGE_PERIODS) & (
            until - due[np.minimum(after, due.size - 1)] < STALL_LATE * NS
        )
    return np.stack([first, after], axis=1)[out]


def faults_of(name: str, due: Integers, found: Integers) -> tuple[Fault, ...]:
    """Fault of a link that was out, if it was: the outages as rows (k, 2) of its samples."""
    if not found.size:
        return ()
    begin, end = due[found[:, 0]], due[np.minimum(found[:, 1], due.size - 1)]
    lost, longest = int(np.sum(found[:, 1] - found[:, 0])), float((end - begin).max()) / NS
    span = float(begin.min()) / NS, float(end.max()) / NS
    first, last = instants(*span)
    when = f"From {first} to {last} nothing came through {name}"
    if len(found) > 1:
        when = f"{len(found)} times {when[0].lower()}{when[1:]}, for up to {longest:.3g} s"
    words = (
        f"{when}: {lost} samples of {SOURCES[name]} were lost or late, and the loop went on with older "
        "ones. Check network, cables and hosts there; the energy balance of the test holds what that did."
    )
    return (Fault(f"link.{name}", "dropout", link_topic(name), words, span, float(lost)),)
