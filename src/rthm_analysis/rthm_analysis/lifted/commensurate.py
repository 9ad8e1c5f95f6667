"""Clocks that never, or hardly ever, tick together again: the nearest ones that do.

The periods of a cycle are T / n_i with whole n_i, so T is sought near a whole multiple of the longest period
for which all T / n_i are nearest to the true periods. The relative error of every period is returned with the
cycle; delays keep their values. Over one cycle the phases between the clocks then drift as the true ones do,
which is what counts: clocks set equal to round numbers would never leave their phase, and true ones do.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.lifted.cycle import Cycle, cycle, hyperperiod
from rthm_analysis.lifted.predictor import history_of
from rthm_core.kept import kept_by_clocks
from rthm_core.schedule import Schedule

if TYPE_CHECKING:
    from rthm_core.spec import Spec

MOST_EVENTS = 20_000
"""Events in the longest cycle that is followed exactly."""

FINEST_NS = 0.1
"""Unit of time of an approximate cycle, at most."""

CLOCKS = ("td1", "td2", "td3", "td4")


class Period(NamedTuple):
    """A cycle, and how far its clocks are from the true ones (relative; 0: exact)."""

    cycle: Cycle
    error: float


def commensurate(schedule: Schedule, most: int = MOST_EVENTS, history: int = 0) -> Period:
    """Cycle of a schedule: exact if it has at most about `most` events, else of the nearest clocks."""
    periods = {name: getattr(schedule, name) for name in CLOCKS if getattr(schedule, name) > 0}
    events_per_ns = sum((1 if name == "td4" else 4) / periods[name] for name in periods if name != "td1")
    duration = hyperperiod(schedule)
    if duration * events_per_ns <= most:
        return Period(cycle(schedule, history=history), 0.0)
    longest = max(periods.values())
    ratios = longest / np.array(list(periods.values()), dtype=float)
    multiples = np.arange(1, max(2, int(most / (events_per_ns * longest))) + 1)
    ticks = np.rint(multiples[:, None] * ratios)
    errors = np.abs(multiples[:, None] * ratios / ticks - 1.0).max(axis=1)
    best = int(np.argmin(errors))
    chosen = dict(zip(periods, ticks[best].astype(int).tolist(), strict=True))
    unit = _retime(schedule, chosen, int(multiples[best]) * longest)
    return Period(cycle(schedule, unit, history), float(errors[best]))


def _retime(schedule: Schedule, ticks: dict[str, int], duration_ns: int) -> float:
    """Give every clock a number of ticks in `duration_ns`; returns the schedule's new unit of time, s."""
    common = math.lcm(*ticks.values())
    duration = common * max(1, math.ceil(duration_ns / (FINEST_NS * common)))
    unit_ns = duration_ns / duration
    for name, count in ticks.items():
        setattr(schedule, name, duration // count)
    for link in schedule.links.values():
        link.delay_ns = round(link.delay_ns / unit_ns)
    schedule.motor_delay = round(schedule.motor_delay / unit_ns)
    return unit_ns * 1e-9


def period_of(spec: Spec, most: int = MOST_EVENTS) -> Period:
    """Cycle of a linear loop."""
    return _period(spec, most, history_of(spec))


@kept_by_clocks
def _period(spec: Spec, most: int, history: int) -> Period:
    return commensurate(Schedule(spec), most, history)
