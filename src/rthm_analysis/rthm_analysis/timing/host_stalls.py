"""When a host stalled, as the times show at which samples and uses were sent.

A part sends what belongs to an instant shortly after it, always by the same little. What is sent much later
tells of a stall: its host did other work, or a virtual machine was not running. Samples on their way at that
time may be late whatever their link does. Who asks what a link does leaves them out, whether they came late
or not, so that leaving them out favours neither answer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_analysis.recording import LinkTable, Recording, Table
    from rthm_core.compiled import Flags, Integers

LATE_NS = 1_000_000
"""What is sent this much later than usual tells of a stall."""

AFTER_NS = 1_000_000
"""Time in which a machine catches up."""

FAR = np.iinfo(np.int64).max


def host_stalls(recording: Recording) -> Integers:
    """Spans of time in which some host of the test stalled, ns after the start, shape (k, 2), ascending.

    Empty where the recording does not tell when samples were sent.
    """
    told: list[tuple[Integers, Table | LinkTable]]
    told = [(table.stamp_ns, table) for topic, table in recording.tables.items() if topic != "energy"]
    told += [(link.use_ns, link) for link in recording.links.values()]
    spans = [
        _stalls_of(at, source.sent_ns) for at, source in told if (source.sent_ns != source.received_ns).any()
    ]
    return _merged(np.concatenate([np.empty((0, 2), dtype=np.int64), *spans]) - recording.start_ns)


def _stalls_of(at: Integers, sent: Integers) -> Integers:
    """From the instant `at` to which a message belongs until its sender has caught up, where it was late."""
    late = sent - at
    held = late > np.median(late) + LATE_NS
    return np.stack([at[held], sent[held] + AFTER_NS], axis=1)


def _merged(spans: Integers) -> Integers:
    """Union of spans."""
    spans = spans[np.argsort(spans[:, 0])]
    until = np.maximum.accumulate(spans[:, 1])
    first = np.flatnonzero(np.append(True, spans[1:, 0] > until[:-1])[: len(spans)])
    last = np.append(first[1:] - 1, len(spans) - 1)[: first.size]
    return np.stack([spans[first, 0], until[last]], axis=1)


class HostStalls(NamedTuple):
    """How often a host stalled, for which share of a test, and how long at most, s."""

    count: int  # type: ignore[assignment]
    share: float
    longest: float


def stall_statistics(spans: Integers, duration: float) -> HostStalls:
    """Sum of the spans of `host_stalls` in a test of `duration` s."""
    lengths = (spans[:, 1] - spans[:, 0]) / NS
    share = float(lengths.sum()) / max(duration, 1.0 / NS)
    return HostStalls(len(lengths), share, float(lengths.max(initial=0.0)))


def stalled_between(spans: Integers, begin: Integers, end: Integers) -> Flags:
    """Whether a host stalled at some time from each `begin` to its `end` (n,)."""
    return next_stall(spans, begin) <= end


def next_stall(spans: Integers, at: Integers) -> Integers:
    """Begin of the first span that is not over at each instant."""
    return np.append(spans[:, 0], FAR)[np.searchsorted(spans[:, 1], at)]
