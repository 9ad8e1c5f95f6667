"""Age of every sample at its use, and by how much that is more than the exact schedule's age.

sample k of the source        use j of the receiver
--|---------------------------------------|-------------->
  stamp       age = use - stamp            use
  stamp       exact age            |excess |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rthm_analysis.recording import LinkTable, Recording, Table
from rthm_analysis.recording.uses import LONGEST_STALL, tick_of_each
from rthm_analysis.timing.host_stalls import stalled_between
from rthm_core.clock import NS
from rthm_core.compiled import Flags, Floats, Integers
from rthm_core.link import NEVER, Link
from rthm_core.schedule import Schedule, newest, newest_arrived
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE, PLANT_STATE

SOURCES = {
    "tau1": PLANT_STATE,
    "tau2": PLANT_STATE,
    "tau3": FORCE_REFERENCE,
    "tau4": COMMAND,
}
"""Topic of the samples that go over each link."""

LATE_NS = 1_000_000
"""A use that comes by more than this after the end of its delay is late, unless the receiver tells better."""


@dataclass(frozen=True)
class LinkTiming:
    """Uses of one link.

    Attributes
    ----------
    use : (n,) array
        Instants of use, s after the start of the test.
    age, excess : (n,) arrays
        Age of the sample at its use, and that age minus the one of the exact schedule, s; NaN: not known.
    undisturbed : (n,) array
        Where the host did not stall between the stamp of the sample that was due and its instant of use.
    lost, late : int
        Samples that never arrived, and uses at which the sample that was due had not arrived in time.
    """

    use: Floats
    age: Floats
    excess: Floats
    undisturbed: Flags
    lost: int
    late: int

    def as_dict(self) -> dict[str, object]:
        """Contract, section 5: ``links.tau1``."""
        numbers = {"lost": self.lost, "late": self.late, "count": int(self.use.size)}
        apart = distribution(self.excess[self.undisturbed])
        return {
            "age": distribution(self.age),
            "excess": distribution(self.excess),
            "excess_undisturbed": apart,
            **numbers,
        }


def distribution(values: Floats) -> dict[str, float | None]:
    """Mean, median, 99th percentile and maximum; None where there is nothing to tell."""
    known = values[np.isfinite(values)]
    if not known.size:
        return dict.fromkeys(("mean", "p50", "p99", "max"))
    median, high = np.quantile(known, [0.5, 0.99])
    return {"mean": float(known.mean()), "p50": float(median), "p99": float(high), "max": float(known.max())}


def ticks_of(uses: Integers, period: int) -> Integers:
    """Number of the tick, from the start of the test, of each of the ascending `uses`; -1: none.

    A use may precede its tick by a twentieth of a period, for receivers that tell the time less exactly.
    """
    if not uses.size:
        return uses
    first = max(int(uses[0]) // period - LONGEST_STALL, 0)
    count = int(uses[-1]) // period + 2 - first
    if count > 100 * uses.size + 10 * LONGEST_STALL:
        return np.maximum(uses // period, -1)
    ticks = (first + np.arange(max(count, 1), dtype=np.int64)) * period
    number = tick_of_each(uses, ticks - period // 20, period)
    return np.where(number < 0, -1, first + number)


def clock_of(name: str, schedule: Schedule) -> tuple[int, int]:
    """Periods in ns of a link's source and of its receiver; 0: at once when a sample is due."""
    source = {"tau1": schedule.td1, "tau2": schedule.td1, "tau3": schedule.td2, "tau4": 0}
    receiver = {"tau1": schedule.td3, "tau2": schedule.td2, "tau3": schedule.td4, "tau4": 0}
    return source[name], receiver[name]


def link_timing(
    recording: Recording, schedule: Schedule, name: str, spans: Integers
) -> tuple[LinkTiming, list[str]]:
    """Timing of one link, and what could not be measured, as sentences; `spans` as from `host_stalls`."""
    source = recording.tables.get(SOURCES[name])
    uses, notes = _uses(recording, schedule, name, source)
    if uses is None:
        return LinkTiming(*(np.empty(0),) * 3, np.empty(0, dtype=bool), 0, 0), notes
    use, sample = uses.use_ns - recording.start_ns, uses.sample_ns - recording.start_ns
    exact, due = _exact_age(schedule, name, use, sample)
    stamped = (use - sample).astype(float)
    hidden = recording.clocks.missing_age_ns(name, uses.use_ns, uses.sample_ns)
    age, excess = stamped + hidden, np.where(exact == NEVER, np.nan, stamped - exact)
    told = _told(recording.diagnostics, name)
    stamps = source.stamp_ns - recording.start_ns if source else np.empty(0, dtype=np.int64)
    lost = max(_lost(schedule, name, stamps, use, sample), told.get("lost", 0))
    late = max(_late(schedule, name, excess), told.get("late", 0))
    undisturbed = (exact != NEVER) & ~stalled_between(spans, np.where(exact == NEVER, due, due - exact), due)
    return LinkTiming(use / NS, age / NS, (excess + hidden) / NS, undisturbed, lost, late), notes


def _uses(
    recording: Recording, schedule: Schedule, name: str, source: Table | None
) -> tuple[LinkTable | None, list[str]]:
    if name in recording.links:
        return recording.links[name], []
    derived = derived_uses(recording, schedule, name) if source else None
    if derived is None or not len(derived):
        return None, [f"links/{name} is not recorded, and cannot be derived: its delay is not known."]
    return derived, [f"links/{name} is not recorded: taken as the exact schedule's on the recorded stamps."]


def derived_uses(recording: Recording, schedule: Schedule, name: str) -> LinkTable | None:
    """Uses that the exact schedule gives for the recorded stamps; None when the receiver left no trace."""
    source = recording.tables[SOURCES[name]]
    due = due_of(schedule.links[name], source.stamp_ns - recording.start_ns)
    receivers = {"tau1": COMMAND, "tau2": NUMERICAL_STATE}
    if name not in receivers:
        kept = due < NEVER
        use, sample = due[kept], source.stamp_ns[kept] - recording.start_ns
    elif receivers[name] in recording.tables:
        use = recording.tables[receivers[name]].stamp_ns - recording.start_ns
        use = use[use % clock_of(name, schedule)[1] == 0]
        row = newest_arrived(np.arange(due.size), due, use)
        use, sample = use[row >= 0], source.stamp_ns[row[row >= 0]] - recording.start_ns
    else:
        return None
    order = np.argsort(use, kind="stable")
    use, sample = use[order] + recording.start_ns, sample[order] + recording.start_ns
    return LinkTable(use, sample, use, use)


def due_of(link: Link, stamps: Integers) -> Integers:
    """End of the delay of samples stamped `stamps` (ns after the start); NEVER: lost."""
    return link.due_all(stamps)


def _exact_age(schedule: Schedule, name: str, use: Integers, sample: Integers) -> tuple[Integers, Integers]:
    """Age in ns that the exact schedule gives at each use, NEVER where it gives none; its instant of use."""
    link, (source, receiver) = schedule.links[name], clock_of(name, schedule)
    if receiver == 0:
        due = due_of(link, sample)
        again = np.append(False, np.diff(sample) == 0)[: sample.size]
        return np.where((due == NEVER) | again, NEVER, due - sample), due
    tick = ticks_of(use, receiver)
    instants = np.maximum.accumulate(np.maximum(tick, 0)) * receiver
    number = newest(link, source, instants)
    return np.where((tick < 0) | (number < 0), NEVER, instants - number * source), instants


def _lost(schedule: Schedule, name: str, stamps: Integers, use: Integers, sample: Integers) -> int:
    """Samples that the link lost by the spec, and, where every sample is used, those that were never used.

    A sample is only overtaken, not lost, when a newer one was in use before its own delay was over.
    """
    link, (source, receiver) = schedule.links[name], clock_of(name, schedule)
    due = due_of(link, stamps)
    if receiver:
        gaps = int(np.sum(np.maximum(np.rint(np.diff(stamps) / source) - 1, 0))) if source else 0
        return int(np.count_nonzero(due == NEVER)) + gaps
    if not use.size:
        return 0
    unused = ~np.isin(stamps, sample) & ((due == NEVER) | (due <= use[-1])) & (stamps <= sample.max())
    order = np.argsort(sample, kind="stable")
    earliest = np.minimum.accumulate(use[order][::-1])[::-1]
    row = np.searchsorted(sample[order], stamps, side="right")
    overtaken = (row < order.size) & (
        earliest[np.minimum(row, order.size - 1)] <= np.where(due == NEVER, -1, due)
    )
    return int(np.count_nonzero(unused & ~overtaken))


def _late(schedule: Schedule, name: str, excess: Floats) -> int:
    """Uses of an older sample than the schedule has there, or of a sample whose delay had long been over."""
    source, receiver = clock_of(name, schedule)
    tolerance = source // 2 if receiver else LATE_NS
    return int(np.count_nonzero(excess[np.isfinite(excess)] > tolerance))


def _told(diagnostics: Mapping[str, Mapping[str, str]], name: str) -> dict[str, int]:
    """What the receiver itself counted."""
    counts: dict[str, int] = {}
    for values in diagnostics.values():
        for what in ("lost", "late"):
            text = values.get(f"{name} {what}", "")
            if text.isdecimal():
                counts[what] = max(counts.get(what, 0), int(text))
    return counts
