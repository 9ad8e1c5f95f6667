"""Timing: what the delays and clocks of a recorded test really were, against the exact schedule."""

from rthm_analysis.timing.clocks import ClockTiming
from rthm_analysis.timing.links import LinkTiming
from rthm_analysis.timing.recorded import RecordedSchedule
from rthm_analysis.timing.result import TimingResult, timing_of

__all__ = ["ClockTiming", "LinkTiming", "RecordedSchedule", "TimingResult", "timing_of"]
