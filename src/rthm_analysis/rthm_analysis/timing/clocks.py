"""Period and missed ticks of every clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.recording import Recording
from rthm_analysis.timing.links import ticks_of
from rthm_core.clock import NS
from rthm_core.clocks import TICKS
from rthm_core.compiled import Floats, Integers
from rthm_core.topics import COMMAND

CLOCKS = {
    "td1": (TICKS["td1"], None),
    "td2": (TICKS["td2"], "tau2"),
    "td3": (TICKS["td3"], "tau1"),
    "td4": (None, "tau3"),
}
"""Topic that is stamped with the ticks of a clock, and link whose uses tell when they were really done."""


@dataclass(frozen=True)
class ClockTiming:
    """Ticks of one clock.

    Attributes
    ----------
    period : (n,) array
        Times from tick to tick as they were done, s.
    missed : int
        Ticks that never were, or ended only after the next one was due.
    """

    period: Floats
    missed: int

    def as_dict(self) -> dict[str, object]:
        """Contract, section 5: ``clocks.td1``."""
        known = self.period.size > 0
        return {
            "period_mean": float(self.period.mean()) if known else None,
            "period_p99": float(np.quantile(self.period, 0.99)) if known else None,
            "missed": self.missed,
        }


def clock_timing(recording: Recording, name: str, period_ns: int) -> ClockTiming | None:
    """Timing of the clock `name`, or None when it left no trace."""
    topic, link = CLOCKS[name]
    table = recording.tables.get(topic) if topic else None
    uses = recording.links.get(link) if link else None
    if table is None and uses is None:
        return None
    done = uses.use_ns - recording.start_ns if uses else np.empty(0, dtype=np.int64)
    stamps = table.stamp_ns - recording.start_ns if table else done
    if topic == COMMAND:
        stamps = stamps[stamps % period_ns == 0]
    missed = max(_absent(stamps, period_ns) + _overrun(done, period_ns), _told(recording, name))
    return ClockTiming(np.diff(done if done.size else stamps) / NS, missed)


def _absent(stamps: Integers, period: int) -> int:
    """Ticks between the first and the last stamp that have no sample."""
    return int(np.sum(np.maximum(np.rint(np.diff(stamps) / period) - 1, 0)))


def _overrun(done: Integers, period: int) -> int:
    """Ticks that were done only after the next one was due."""
    tick = ticks_of(done, period)
    return int(np.count_nonzero((tick >= 0) & (done - tick * period > period)))


def _told(recording: Recording, name: str) -> int:
    """Missed deadlines that the node itself counted."""
    key = f"{name.capitalize()} missed deadlines"
    told = [values[key] for values in recording.diagnostics.values() if key in values]
    return max((int(text) for text in told if text.isdecimal()), default=0)
