"""Periods and delays of a recorded test, from its stamps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_core.clock import NS
from rthm_core.topics import COMMAND, LINKS, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_analysis.recording import LinkTable, Recording
    from rthm_core.compiled import Integers

CLOCKS = 2e-4
"""Relative difference of two periods that clocks make."""

SAME_PERIOD = 0.01
"""Relative difference of two periods that are the same all the same."""

ALWAYS = 1e-5
"""Time by which every use in real time may be late, s."""

PERIOD_DIGITS = 9


def timing_of(recording: Recording, *, is_loop: bool) -> tuple[dict[str, float], list[str]]:
    """Entries of the section ``timing``, s, and what the recording does not tell of it.

    A plant alone has one clock, that of its samples; the others are written as the same.

    Parameters
    ----------
    recording : Recording
    is_loop : bool
        Whether it is of a hybrid test.
    """
    td1 = period(recording.plant.stamp_ns)
    if not is_loop:
        return {"td1": td1, "td2": td1, "td3": td1} | dict.fromkeys(("td4", *LINKS), 0.0), []
    links = recording.links
    td2 = period(recording.tables[NUMERICAL_STATE].stamp_ns)
    ticks = links["tau1"].use_ns if "tau1" in links else recording.tables[COMMAND].stamp_ns
    td3 = period(ticks)
    found = {"td1": td1, "td2": td2, "td3": td3, "td4": 0.0}
    found |= {name: _kept(links.get(name), source) for name, source in (("tau1", td1), ("tau2", td1))}
    if "tau3" in links:
        own = period(links["tau3"].use_ns)
        if abs(own - td2) > SAME_PERIOD * td2:
            found["td4"], found["tau3"] = own, _kept(links["tau3"], td2)
    found = {"tau3": _at_once(links.get("tau3"))} | found | {"tau4": _at_once(links.get("tau4"))}
    missing = [name for name in LINKS if name not in links]
    return found, [f"The uses of link {name} are not recorded: its delay is taken as 0." for name in missing]


def period(stamps_ns: Integers) -> float:
    """Period of a clock that may have missed ticks, s; as round as clocks are good.

    Examples
    --------
    >>> period(np.array([0, 1_200_010, 2_400_000, 4_800_120]))
    0.0012
    """
    steps = np.diff(stamps_ns)
    steps = steps[steps > 0]
    if not steps.size:
        return 1e-3
    ticks = np.rint(steps / np.median(steps)).sum()
    mean = float(steps.sum() / ticks) / NS
    return simplest(mean * (1.0 - CLOCKS), mean * (1.0 + CLOCKS), mean)


def simplest(low: float, high: float, nearest: float) -> float:
    """Number with the fewest digits from `low` to `high`, the one that is next to `nearest`.

    Examples
    --------
    >>> simplest(0.0072, 0.0084, 0.0084), simplest(0.00123, 0.00123, 0.00123)
    (0.008, 0.00123)
    """
    for digits in range(1, PERIOD_DIGITS):
        rounded = float(f"{nearest:.{digits}g}")
        step = 10.0 ** (np.floor(np.log10(abs(nearest))) - digits + 1) if nearest else 0.0
        for one in (rounded, rounded - step, rounded + step):
            value = float(f"{one:.{digits}g}")
            if low - 1e-12 <= value <= high + 1e-12:
                return value
    return round(nearest, PERIOD_DIGITS)


def _kept(link: LinkTable | None, source: float) -> float:
    """Delay of a link whose receiver looks at its own ticks: samples come every `source` s."""
    if link is None or not len(link):
        return 0.0
    age = (link.use_ns - link.sample_ns) / NS
    least = float(age.min())
    low = float(np.median(age)) - source
    low = float(age.max()) - source if age.max() - least < source else low
    return max(simplest(min(low + 1e-9, least), least, least), 0.0)


def _at_once(link: LinkTable | None) -> float:
    """Delay of a link whose samples are used when they are due."""
    if link is None or not len(link):
        return 0.0
    age = (link.use_ns - link.sample_ns) / NS
    least, usual = float(age.min()), float(np.median(age))
    late = max(3.0 * (usual - least), ALWAYS) if usual > least else 0.0
    return max(simplest(least - late, least, least), 0.0)
