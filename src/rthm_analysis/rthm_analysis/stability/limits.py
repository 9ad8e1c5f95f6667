"""How far a loop is from the edge: every crossing over all periods and delays, each alone, and k_tot."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.lifted.commensurate import commensurate
from rthm_analysis.lifted.cycle import Cycle
from rthm_analysis.lifted.matrices import LinearLoop, linear_loop
from rthm_analysis.stability.rates import EVENTS_IN_A_SEARCH, of_delay, of_k_tot, of_period, of_scale
from rthm_analysis.stability.search import Crossing, Scan, scan
from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.errors import InputError
from rthm_core.schedule import Schedule
from rthm_core.spec import apply
from rthm_core.topics import LINKS

if TYPE_CHECKING:
    from rthm_core.spec import Spec

LARGEST_FACTOR = 100.0
"""Factor up to which periods and delays are searched."""

K_TOT_FACTOR = 1e4
"""k_tot is searched from its value divided by this to its value times this."""

SCAN_PHASE = 0.4
"""Step of a scan: radians by which the fastest oscillation of the two sides shifts in it."""

FEWEST, MOST = 100, 4000
"""Points of a first scan."""

MOST_PLACES = 160
"""A delay alone is searched as far as at most this many samples are under way at the cut."""

FINEST_FACTOR, FINEST_DELAY = 1e-9, 1e-9
"""Distance to which an edge is known: in a factor, and in a delay, s."""

LATTICE_POINTS = 200
"""Periods that are tried before the neighbourhood of each crossing is."""

DELAYS, PERIODS = LINKS, ("td1", "td2", "td3", "td4")


@dataclass(frozen=True)
class Limit:
    """Stability over one parameter.

    Attributes
    ----------
    nominal : float
        Value in the spec.
    scan : Scan
        Crossings in the unit of the parameter, and the range that was searched.
    resolution : float
        Distance to which a crossing is known, in the unit of the parameter.
    start : float
        Value from which on the first loss of stability counts.
    """

    nominal: float
    scan: Scan
    resolution: float
    start: float = 0.0

    @property
    def critical_value(self) -> float | None:
        """Value at which stability is first lost as the parameter grows from `start`; `start` itself if the
        loop is not stable there, None if it stays stable.
        """
        return self.scan.first_lost(self.start)

    @property
    def critical_scale(self) -> float | None:
        """The same as a factor on the nominal value."""
        value = self.critical_value
        return None if value is None or self.nominal == 0.0 else value / self.nominal

    def as_dict(self) -> dict[str, object]:
        """Entry of ``limits`` in the JSON of ``rthm stability``."""
        return {
            "nominal": self.nominal,
            "critical_scale": self.critical_scale,
            "critical_value": self.critical_value,
            "crossings": [{"value": one.value, "lost": one.lost} for one in self.scan.crossings],
            "searched": [self.scan.begin, self.scan.end],
            "resolution": self.resolution,
        }


def _points(loop: LinearLoop, begin: float, end: float, seconds: float, fewest: int) -> Floats:
    """First points of a scan over a parameter that changes the time round the loop by `seconds` in all."""
    count = int(loop.fastest_oscillation * seconds / SCAN_PHASE) + 1
    return np.linspace(begin, end, min(max(count, fewest), MOST))


def scale_points(spec: Spec, loop: LinearLoop, upto: float, fewest: int = FEWEST) -> Floats:
    """First factors on all periods and delays: from next to zero, where the loop is the ideal system."""
    seconds = upto * sum(value for _, value in spec.loop().timing.items())
    return np.concatenate([[1e-3, 1e-2, 0.1], _points(loop, 1e-3, upto, seconds, fewest)[1:]])


def scale_limit(spec: Spec, loop: LinearLoop, cycle: Cycle, upto: float = LARGEST_FACTOR) -> Limit:
    """Factor on all periods and delays, from zero to `upto`."""
    found = scan(of_scale(loop, cycle), scale_points(spec, loop, upto), FINEST_FACTOR)
    return Limit(1.0, _from_zero(found), FINEST_FACTOR)


def _from_zero(found: Scan) -> Scan:
    """A search that starts next to zero has begun at zero."""
    return found._replace(begin=0.0)


def delay_points(spec: Spec, loop: LinearLoop, name: str, upto: float, fewest: int = FEWEST) -> Floats:
    """First values of one delay alone, s: from zero to `upto` times its value (of the longest delay when it
    is zero), or as far as not too much is under way.
    """
    timing = spec.loop().timing
    nominal = float(getattr(timing, name))
    end = upto * (nominal or max(getattr(timing, one) for one in DELAYS) or timing.td2)
    end = _affordable(spec, loop, name, end)
    return _points(loop, 0.0, end, end, fewest)


def delay_limit(spec: Spec, loop: LinearLoop, name: str, upto: float = LARGEST_FACTOR) -> Limit:
    """One delay alone, s (see `delay_points`)."""
    found = scan(of_delay(spec, loop, name), delay_points(spec, loop, name, upto), FINEST_DELAY)
    return Limit(float(getattr(spec.loop().timing, name)), found, FINEST_DELAY)


def can_be_searched(cycle: Cycle) -> bool:
    """Whether few enough samples are under way in a loop for its limits to be searched."""
    return cycle.kept.size <= MOST_PLACES


def check_searchable(cycle: Cycle) -> None:
    """Refuse to search the limits of a loop in which very many samples are under way.

    Raises
    ------
    InputError
        If there are more than `MOST_PLACES`.
    """
    if not can_be_searched(cycle):
        raise InputError(
            f"{cycle.kept.size} samples are in transit at once; limits can be computed for at most "
            f"{MOST_PLACES}; shorten the delays, or judge only the spec itself: rthm stability --no-limits."
        )


def _affordable(spec: Spec, loop: LinearLoop, name: str, end: float) -> float:
    """Value in s of a delay, at most `end`, up to which at most MOST_PLACES samples are under way."""
    schedule = Schedule(spec)
    beside = schedule.links[name].beside_ns
    while True:
        longest = schedule.copied()
        longest.links[name].delay_ns = max(0, beside + to_ns(end))
        under_way = commensurate(longest, EVENTS_IN_A_SEARCH, loop.history).cycle.kept.size
        if under_way <= MOST_PLACES:
            return end
        end *= 0.95 * MOST_PLACES / under_way


def period_limit(spec: Spec, loop: LinearLoop, name: str) -> Limit | None:
    """One period alone, up to a hundred times its value, s; None for a Td4 of zero.

    What a loop does depends on which clocks stay in phase, so it is not continuous over a period. Periods are
    therefore taken from a lattice: multiples of the greatest common divisor of all of them.
    """
    timing = spec.loop().timing
    nominal = timing.ns(name)
    if nominal == 0:
        return None
    end = round(LARGEST_FACTOR * nominal)
    common = math.gcd(*(timing.ns(one) for one in PERIODS if timing.ns(one) > 0))
    lattice = max(common, round(end / MOST))
    count = min(end // lattice, LATTICE_POINTS)
    points = np.unique(np.rint(np.linspace(1, end // lattice, count))) * lattice * 1e-9
    resolution = lattice * 1e-9
    found = scan(of_period(spec, loop, name, lattice), points, resolution, finest=np.inf)
    return Limit(nominal * 1e-9, _from_zero(found), resolution)


def k_tot_limit(spec: Spec, cycle: Cycle) -> Limit:
    """Factor on every k_tot; a transmission is taken as the static stiffness that it has."""
    points = np.linspace(-math.log(K_TOT_FACTOR), math.log(K_TOT_FACTOR), 400)
    found = scan(of_k_tot(_loops_over_k_tot(spec), cycle), points, 1e-10)
    factors = tuple(Crossing(math.exp(one.value), one.lost) for one in found.crossings)
    over = Scan(factors, found.stable_at_begin, 1.0 / K_TOT_FACTOR, K_TOT_FACTOR)
    return Limit(1.0, over, 1e-9, start=1.0)


def _loops_over_k_tot(spec: Spec) -> Callable[[float], LinearLoop]:
    """Loop for a factor on k_tot: its dynamics are affine in k_tot, so two loops give them all."""
    one, two = (
        linear_loop(apply(spec, {"actuator.stiffness": [factor * k for k in spec.k_tot]}))
        for factor in (1.0, 2.0)
    )

    def loop(factor: float) -> LinearLoop:
        return one._replace(
            a1=one.a1 + (factor - 1.0) * (two.a1 - one.a1),
            b1=one.b1 + (factor - 1.0) * (two.b1 - one.b1),
            flexibility=np.where(one.flexibility == two.flexibility, 1.0, 1.0 / factor) * one.flexibility,
        )

    return loop
