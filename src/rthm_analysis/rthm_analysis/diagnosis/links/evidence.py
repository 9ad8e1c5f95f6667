"""What the uses of a link say about the extra delay of every single sample.

A receiver on a clock uses at each tick the newest sample that has arrived. A sample that was passed over at
one tick and used at the next arrived in between::

    sample j   stamp + tau        tick             tick
    --|------------|---------------|----------------|------->
      stamp        |<---- lo ----->|  not yet here  |  used
                   |<------------- hi ------------->|          lo < extra delay <= hi

A sample that is never used, though no newer one was there, was lost or came later still: ``hi`` is infinite.
This is all that the uses say, and given the extra delays of all samples they follow: the likelihood of the
uses is the product over the samples of P(lo < extra delay <= hi).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import (
    AS_COMMANDED_SHARE,
    AS_DRAWN_SHARE,
    LINK_FEWEST_USES,
    USE_GRAIN,
    USE_TOLD_NS,
)
from rthm_analysis.diagnosis.links.host_stalls import without_stalls
from rthm_analysis.diagnosis.links.outages import outages
from rthm_analysis.diagnosis.links.stalls import overtaken_after_stalls, stalled_at_ticks
from rthm_analysis.diagnosis.links.stamps import stamp_offset
from rthm_analysis.recording import LinkTable, Recording, rows_of
from rthm_analysis.timing.links import SOURCES, clock_of, ticks_of
from rthm_core.clock import NS
from rthm_core.link import NEVER
from rthm_core.schedule import Schedule
from rthm_core.topics import COMMAND, FORCE_REFERENCE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class LinkEvidence:
    """Extra delays of the samples of one link, as intervals.

    Attributes
    ----------
    name : str
        ``tau1`` to ``tau4``.
    stamp : (n,) array
        Stamps of the samples as the receiver read them, ns after the start, ascending.
    low, high : (n,) arrays
        ``low < extra delay <= high``, s; ``high`` infinite: never used.
    due : (n,) array
        When the spec says that the samples arrive, given these stamps, ns.
    offset_ns : int
        Stamps as the receiver read them minus those by a clock of its own, beyond what the spec says.
    offset_std : float
        By how much that may be wrong, s.
    use_ns : (u,) array
        Instants of use: of the tick, where the receiver is on a clock.
    row : (u,) array
        Sample in use from then on, as a row of `stamp`.
    period_ns : int
        Median time between samples.
    clocked : bool
        Whether the receiver looks only at its ticks.
    host_stalls : (k, 2) array
        When a host stalled, ns: what was on its way then tells nothing.
    outages : (o, 2) array
        First sample that each outage took, and the first one after it.
    """

    name: str
    stamp: Integers
    low: Floats
    high: Floats
    due: Integers
    offset_ns: int
    use_ns: Integers
    row: Integers
    period_ns: int
    clocked: bool
    host_stalls: Integers
    outages: Integers
    offset_std: float = USE_GRAIN

    def between(self, begin_ns: int, end_ns: int) -> LinkEvidence:
        """Return the evidence of the samples stamped, and of the uses made, in a span of time."""
        samples = (self.stamp >= begin_ns) & (self.stamp < end_ns)
        uses = (self.use_ns >= begin_ns) & (self.use_ns < end_ns)
        low, high = np.where(samples, self.low, -np.inf), np.where(samples, self.high, np.inf)
        both = {"low": low, "high": high, "use_ns": self.use_ns[uses], "row": self.row[uses]}
        return LinkEvidence(**(self.__dict__ | both))


def link_evidence(
    recording: Recording, spec: Spec, schedule: Schedule, name: str, spans: Integers
) -> LinkEvidence | str:
    """Evidence of one link, or a sentence that says why there is none."""
    source = recording.tables.get(SOURCES[name])
    if name not in recording.links:
        return f"links/{name} is not recorded: the link cannot be checked."
    if source is None or len(source) < 2 or len(recording.links[name]) < LINK_FEWEST_USES:
        return f"{SOURCES[name]} or links/{name} has too few samples: the link {name} cannot be checked."
    offset = stamp_offset(recording, spec, name, source)
    if offset is None:
        return f"the stamps of links/{name} are not those of {SOURCES[name]}: the link cannot be checked."
    start, link = recording.start_ns, schedule.links[name]
    uses = recording.links[name]
    sent = source.stamp_ns - start + offset
    used = uses.sample_ns - start
    stamp = sent if rows_of(sent, used)[1].all() else np.union1d(sent, used)
    period = int(np.median(np.diff(stamp)))
    receiver = clock_of(name, schedule)[1]
    at, row = _uses(uses, start, stamp, receiver)
    if name == "tau3" and not receiver:
        at, row = _as_commanded(recording, stamp - offset, at, row, link.delay_ns)
    if at.size < LINK_FEWEST_USES:
        return f"links/{name} has too few uses: the link cannot be checked."
    hidden, unsure = _between_hosts(recording, name)
    known = link.offset_ns if offset or hidden else 0
    due = link.due_all(stamp) - known
    low, high = _intervals(due, at, row, exact=not receiver)
    stalled = stalled_at_ticks(due, at, row) if receiver else overtaken_after_stalls(high, row)
    low[stalled], high[stalled] = -np.inf, np.inf
    out = outages(due, at, row, receiver)
    for first, after in out:
        low[first:after], high[first:after] = -np.inf, np.inf
    low, high = without_stalls(spans, stamp - offset, due, at if receiver else None, low, high)
    if not np.isfinite(low).any() and not np.isfinite(high).any():
        return f"hosts stalled too often: the link {name} cannot be checked."
    if not link.constant:
        low = np.where(due >= NEVER - abs(known), -np.inf, low)
        if not _as_drawn(due, low, high):
            return f"the spec's own jitter or loss of link.{name} was drawn otherwise: it cannot be checked."
    beyond = offset + hidden - known
    beyond = 0 if abs(beyond) * 1e-9 < unsure else beyond
    return LinkEvidence(
        name, stamp, low, high, due, beyond, at, row, period, bool(receiver), spans, out, unsure
    )


def _between_hosts(recording: Recording, name: str) -> tuple[int, float]:
    """Lead of the sender's clock over the receiver's as it was measured, ns, and its uncertainty, s.

    Zero where it was not, or where it may be nothing.
    """
    uses = recording.links[name]
    lead = recording.clocks.missing_age_ns(name, uses.use_ns, uses.sample_ns)
    middle, unsure = int(np.median(lead)), max(USE_GRAIN, recording.clocks.uncertainty(name))
    return (middle, unsure) if abs(middle) * 1e-9 > unsure else (0, USE_GRAIN)


def _as_drawn(due: Integers, low: Floats, high: Floats) -> bool:
    """Whether nearly all samples came when the random numbers of the spec say."""
    told = np.isfinite(high)
    return (
        bool(np.mean((low[told] < USE_GRAIN) & (high[told] >= 0.0)) > AS_DRAWN_SHARE) if told.any() else False
    )


def _uses(uses: LinkTable, start: int, stamp: Integers, receiver: int) -> tuple[Integers, Integers]:
    """Instants of use, by the receiver's clock if it has one, and rows of the samples used."""
    at, row = uses.use_ns - start, np.searchsorted(stamp, uses.sample_ns - start)
    if receiver:
        tick = ticks_of(at, receiver)
        known = tick >= 0
        at, row = tick[known] * receiver, row[known]
    newer = row >= np.maximum.accumulate(row) if row.size else np.empty(0, dtype=bool)
    return at[newer], row[newer]


def _as_commanded(
    recording: Recording, stamp: Integers, at: Integers, row: Integers, delay: int
) -> tuple[Integers, Integers]:
    """Uses of force references as the commands tell them: when a reference first was in a command.

    A command is stamped with the instant for which it was computed, which is exact where the receiver tells
    its uses a little later; and a use that was lost in the recording is told by the command all the same.
    Commands of a compensator hold no reference as it was sent; there, the last command before is taken.
    """
    commands, forces = recording.tables.get(COMMAND), recording.tables[FORCE_REFERENCE]
    if commands is None or not len(commands):
        return at, row
    sent, effort = commands.stamp_ns - recording.start_ns, commands.columns("effort", forces.names)
    which = np.searchsorted(forces.stamp_ns - recording.start_ns, stamp)
    which = np.minimum(which, len(forces) - 1)
    told = forces.effort[which]
    newest = np.maximum(np.searchsorted(sent, at, side="right") - 1, 0)
    same = (effort[newest] == told[row]).all(axis=1) & (sent[newest] <= at)
    if same.mean() < AS_COMMANDED_SHARE:
        soon = (sent[newest] <= at) & (at - sent[newest] < USE_TOLD_NS)
        return np.where(soon, sent[newest], at), row
    at = np.where(same, sent[newest], at)
    missing = np.setdiff1d(np.arange(stamp.size), row)
    after = np.minimum(np.searchsorted(sent, stamp[missing] + delay), sent.size - 1)
    found = (effort[after] == told[missing]).all(axis=1) & (sent[after] >= stamp[missing] + delay)
    found &= (effort[np.maximum(after - 1, 0)] != effort[after]).any(axis=1)
    at, row = np.concatenate([at, sent[after[found]]]), np.concatenate([row, missing[found]])
    order = np.lexsort((row, at))
    at, row = at[order], row[order]
    newer = row >= np.maximum.accumulate(row)
    return at[newer], row[newer]


def _intervals(due: Integers, at: Integers, row: Integers, exact: bool) -> tuple[Floats, Floats]:
    """Bounds of the extra delay of each sample that is nominally due at `due` (n,), s."""
    number = np.arange(due.size)
    first = np.searchsorted(row, number)
    before, here = np.maximum(first - 1, 0), np.minimum(first, at.size - 1)
    known, used = first < at.size, (first < at.size) & (row[here] == number)
    waited = (at[here] - due) / NS
    if exact:
        low = np.where(used, waited - 0.5 * USE_GRAIN, waited)
        high = np.where(used, waited + 0.5 * USE_GRAIN, np.inf)
    else:
        low = np.where(first > 0, (at[before] - due) / NS, -np.inf)
        high = np.where(used, waited, np.inf)
    return np.where(known, low, -np.inf), high
