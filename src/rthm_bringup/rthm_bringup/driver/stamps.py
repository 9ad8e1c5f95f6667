"""Checks of the stamps of a driver: in order, Td1 apart, on a grid of Td1, none missing, in this clock."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rthm_bringup.driver.check import Check
from rthm_bringup.driver.heard import Heard
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec.sections import TimingSpec

QUARTZ = 1e-4
"""Relative error of the period that a clock of its own may have."""

OFF_GRID = 0.1
"""Distance of a stamp from its tick, in periods, that is no fault."""


def stamp_checks(heard: Heard, timing: TimingSpec) -> Iterator[Check]:
    """Checks of stamps that are the same on every host."""
    period, stamps, number = timing.ns("td1"), heard.stamp_ns, heard.number
    backwards = int(np.count_nonzero(np.diff(stamps) <= 0))
    yield Check("stamps increase", not backwards, backwards, "", f"{backwards} are not after the one before")
    yield _period(stamps, number, period)
    tick, off = ticks(stamps, period)
    far = float(np.abs(off).max()) / NS
    allowed = OFF_GRID * period / NS
    words = f"at most {_ms(far)} from first + k Td1; allowed {_ms(allowed)}"
    yield Check("clock grid", far <= allowed, far, "s", words)
    jitter = float(np.quantile(np.abs(np.diff(off)), 0.99)) / NS
    words = f"99 % of the distances of stamps are within {_ms(jitter)} of Td1; allowed {_ms(allowed)}"
    yield Check("period jitter", jitter <= allowed, jitter, "s", words)
    skipped = int(np.maximum(np.diff(tick) - np.diff(number), 0).sum())
    yield Check("no tick left out", not skipped, skipped, "", f"{skipped} ticks of Td1 have no sample")
    lost = int(np.maximum(np.diff(number) - 1, 0).sum())
    yield Check("nothing lost", not lost, lost, "", f"{lost} samples were published and did not arrive")


def age_checks(heard: Heard, timing: TimingSpec) -> Iterator[Check]:
    """Checks of stamps against the clock of this host."""
    youngest, late = float(heard.age.min()), float(np.quantile(heard.age, 0.99))
    words = f"the youngest sample is {_ms(youngest)} old when it arrives; a stamp cannot be in the future"
    yield Check("same clock", youngest >= 0.0, youngest, "s", words)
    delays = {name: getattr(timing, name) for name in ("tau1", "tau2")}
    name = min(delays, key=lambda one: delays[one])
    words = f"99 % arrive within {_ms(late)} of their stamp; {name} of the spec is {_ms(delays[name])}"
    yield Check("arrives in time", late <= delays[name], late, "s", words)


def ticks(stamps: Integers, period: int) -> tuple[Integers, Floats]:
    """Tick of each stamp (s,) on the grid of `period`, ns, that fits best, and its distance from it, ns."""
    since = stamps - stamps[0]
    phase = 2.0 * np.pi * (since % period) / period
    origin = np.angle(np.exp(1j * phase).mean()) / (2.0 * np.pi) * period
    tick = np.rint((since - origin) / period).astype(np.int64)
    return tick, np.asarray(since - origin - tick * period)


def _period(stamps: Integers, number: Integers, period: int) -> Check:
    """Mean distance of samples, by a straight line through their stamps."""
    slope = float(np.polyfit(number, (stamps - stamps[0]).astype(float), 1)[0])
    wrong = slope / period - 1.0
    words = f"{_ms(slope / NS)}, {1e6 * wrong:+.3g} ppm from Td1 = {_ms(period / NS)}"
    return Check("period", abs(wrong) <= QUARTZ, slope / NS, "s", f"{words}; allowed {1e6 * QUARTZ:g} ppm")


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.6g} ms"
