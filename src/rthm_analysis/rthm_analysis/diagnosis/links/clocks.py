"""Periods of the clocks of a test, measured from its stamps, where they are not those of the spec.

Every part stamps what it sends with the instant of its tick, so the stamps tell its period. The controller
also sends commands between two of its ticks, when a reference falls due.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import (
    COMMANDS_PER_REFERENCE,
    FOUND_TICKS_COMMANDED,
    ON_TICK_PERIOD_SHARE,
    OTHER_PERIOD_SHARE,
    PERIOD_FEWEST_STAMPS,
    SPEC_TICKS_COMMANDED,
    WHOLE_PERIOD_TOLERANCE,
    WHOLE_PERIODS_SHARE,
)
from rthm_analysis.recording import Recording
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE, PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Flags, Integers
    from rthm_core.spec import Spec


def other_periods(recording: Recording, spec: Spec) -> dict[str, int]:
    """Periods of the test, in ns, of the clocks ``td1`` to ``td4`` that do not keep to the spec."""
    timing, tables = spec.loop().timing, recording.tables
    found = {
        "td1": _thinned("td1", recording, _period(tables[PLANT_STATE].stamp_ns), timing.ns("td1")),
        "td2": None,
    }
    if NUMERICAL_STATE in tables:
        period = _period(tables[NUMERICAL_STATE].stamp_ns)
        found["td2"] = _thinned("td2", recording, period, timing.ns("td2"))
    td2 = found["td2"] or timing.ns("td2")
    found["td3"] = _controller_period(recording, spec)
    found["td4"] = _reference_period(recording, timing.ns("td4"), td2)
    return {name: period for name, period in found.items() if period is not None}


def _is_other(period: float, nominal: int) -> bool:
    return abs(period - nominal) > OTHER_PERIOD_SHARE * nominal


def _period(stamps: Integers) -> int | None:
    """Mean period of stamps, some of which may be missing, ns; None: they have none."""
    steps = np.diff(stamps)
    if steps.size < PERIOD_FEWEST_STAMPS or np.median(steps) <= 0:
        return None
    numbers = steps / np.median(steps)
    whole = np.abs(numbers - np.rint(numbers)) < WHOLE_PERIOD_TOLERANCE
    if whole.mean() < WHOLE_PERIODS_SHARE:
        return None
    return round(float(steps[whole].sum()) / float(np.rint(numbers[whole]).sum()))


def _thinned(name: str, recording: Recording, period: int | None, nominal: int) -> int | None:
    """Another period than the nominal one, unless only some of the samples were recorded."""
    if period is None or not _is_other(period, nominal):
        return None
    topic, links = {
        "td1": (PLANT_STATE, ("tau1", "tau2")),
        "td2": (FORCE_REFERENCE, ("tau3",)),
    }[name]
    table = recording.tables.get(topic)
    used = [recording.links[link].sample_ns for link in links if link in recording.links]
    share = period / nominal
    if table is None or not used or abs(share - round(share)) > OTHER_PERIOD_SHARE or round(share) < 2:
        return period
    return period if np.isin(np.concatenate(used), table.stamp_ns).mean() > WHOLE_PERIODS_SHARE else None


def _controller_period(recording: Recording, spec: Spec) -> int | None:
    """Period of the controller where the commands do not keep to the spec's."""
    table, nominal = recording.tables.get(COMMAND), spec.loop().timing.ns("td3")
    if table is None or len(table) < PERIOD_FEWEST_STAMPS:
        return None
    stamps = table.stamp_ns - recording.start_ns
    if _explains(stamps, nominal, SPEC_TICKS_COMMANDED, _taken_over(recording)):
        return None
    known = recording.spec.timing.ns("td3") if recording.spec and recording.spec.timing else nominal
    steps = np.concatenate([np.diff(stamps), stamps[2:] - stamps[:-2], stamps[3:] - stamps[:-3]])
    values, counts = np.unique(steps, return_counts=True)
    common = values[np.argsort(counts, kind="stable")[::-1][:12]]
    tried = sorted({known, *common[common > 0].tolist()})
    return next(
        (
            one
            for one in tried
            if _is_other(one, nominal) and _explains(stamps, one, FOUND_TICKS_COMMANDED, None)
        ),
        None,
    )


def _taken_over(recording: Recording) -> int | None:
    """How often a reference was taken over, each time perhaps in a command of its own; None: not known."""
    told = recording.links.get("tau3") or recording.tables.get(FORCE_REFERENCE)
    return None if told is None else len(told)


def _explains(stamps: Integers, period: int, share: float, references: int | None) -> bool:
    """Whether a share of the ticks of a period has commands, and references account for all others."""
    ticks = np.arange(stamps[0] // period + 1, stamps[-1] // period, dtype=np.int64) * period
    on_tick = _near(stamps, ticks, ON_TICK_PERIOD_SHARE * period)
    if ticks.size < PERIOD_FEWEST_STAMPS or np.count_nonzero(on_tick) < share * ticks.size:
        return False
    return bool(
        references is None
        or np.count_nonzero(~on_tick) <= COMMANDS_PER_REFERENCE * references + PERIOD_FEWEST_STAMPS
    )


def _near(stamps: Integers, ticks: Integers, reach: float) -> Flags:
    """Whether each stamp lies within reach of one of the ticks."""
    row = np.clip(np.searchsorted(ticks, stamps), 1, max(ticks.size - 1, 1))
    if ticks.size < 2:
        return np.zeros(stamps.size, dtype=bool)
    return np.asarray(np.minimum(np.abs(stamps - ticks[row]), np.abs(stamps - ticks[row - 1])) <= reach)


def _reference_period(recording: Recording, nominal: int, td2: int) -> int | None:
    """Period at which references are taken over, where it is not the spec's; 0: as soon as they are due.

    On a clock the controller tells a use at each of its ticks; without one, at every reference.
    """
    uses = recording.links.get("tau3")
    period = _period(uses.use_ns) if uses is not None else None
    if period is None:
        return None
    each = not _is_other(period, td2)
    if nominal == 0:
        return None if each else period
    if not _is_other(period, nominal):
        return None
    return 0 if each else period
