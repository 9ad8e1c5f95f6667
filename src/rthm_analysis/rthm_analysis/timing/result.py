"""Timing of a whole recording."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from rthm_analysis.recording import Recording
from rthm_analysis.recording.host_clocks import HostClocks
from rthm_analysis.timing.clocks import ClockTiming, clock_timing
from rthm_analysis.timing.host_stalls import HostStalls, host_stalls, stall_statistics
from rthm_analysis.timing.links import LinkTiming, link_timing
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec
from rthm_core.topics import LINKS


@dataclass(frozen=True)
class TimingResult:
    """Delays and clocks of a recorded test.

    Attributes
    ----------
    links : dict of LinkTiming
        By name, ``tau1`` to ``tau4``; empty for a plant alone.
    clocks : dict of ClockTiming
        By name, ``td1`` to ``td3``, and ``td4`` where the spec has such a clock.
    stalls : HostStalls
        How often and how long hosts of the test stalled.
    notes : tuple of str
        What could not be measured, and why.
    hosts : HostClocks
        Clocks of other hosts; ages are corrected by them.
    """

    links: dict[str, LinkTiming]
    clocks: dict[str, ClockTiming]
    stalls: HostStalls
    notes: tuple[str, ...]
    hosts: HostClocks = field(default_factory=HostClocks)

    @property
    def missed(self) -> int:
        """Missed ticks of all clocks together."""
        return sum(clock.missed for clock in self.clocks.values())

    def as_dict(self) -> dict[str, object]:
        """Contract, section 5: keys of ``rthm timing --json``."""
        return {
            "links": {name: link.as_dict() for name, link in self.links.items()},
            "clocks": {name: clock.as_dict() for name, clock in self.clocks.items()},
            "held_up": self.stalls._asdict(),
            "hosts": {name: clock.as_dict() for name, clock in self.hosts.nodes.items()},
            "notes": list(self.notes),
        }


def timing_of(recording: Recording, spec: Spec | None) -> TimingResult:
    """Measure every delay and every clock of a recording.

    Parameters
    ----------
    recording : Recording
    spec : Spec, optional
        What the test was to be. Without a loop in it, only the plant's own clock can be looked at.
    """
    if spec is None or spec.timing is None or not spec.is_loop:
        return _plant_alone(recording)
    schedule = Schedule(spec)
    links, clocks, notes, spans = {}, {}, [], host_stalls(recording)
    for name in LINKS:
        links[name], missing = link_timing(recording, schedule, name, spans)
        notes += missing
    for name in ("td1", "td2", "td3", "td4"):
        period = spec.timing.ns(name)
        clock = clock_timing(recording, name, period) if period else None
        if clock is not None:
            clocks[name] = clock
        elif period:
            notes.append(f"the clock {name} left no trace in the recording: its period is not known.")
    return TimingResult(
        links, clocks, stall_statistics(spans, recording.duration), tuple(notes), recording.clocks
    )


def _plant_alone(recording: Recording) -> TimingResult:
    stamps = recording.plant.stamp_ns
    period = int(np.median(np.diff(stamps))) if stamps.size > 1 else 0
    clock = clock_timing(recording, "td1", period) if period else None
    note = "there is no loop in the spec: only the clock of the plant was looked at."
    clocks = {"td1": clock} if clock else {}
    return TimingResult({}, clocks, stall_statistics(host_stalls(recording), recording.duration), (note,))
