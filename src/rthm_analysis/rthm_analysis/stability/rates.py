"""Growth rates of a loop as functions of one of its parameters."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.lifted.commensurate import commensurate
from rthm_analysis.lifted.cycle import Cycle
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.matrices import LinearLoop, linear_loop
from rthm_analysis.stability.search import Rates
from rthm_core.clock import NS, to_ns
from rthm_core.compiled import Floats
from rthm_core.schedule import Schedule
from rthm_core.spec import apply

if TYPE_CHECKING:
    from rthm_core.spec import Spec

RATES_SEARCHED = 6
"""How many of the growth rates a search looks at."""

EVENTS_IN_A_SEARCH = 2000
"""A search follows cycles up to this length exactly; its loops are many."""


SLOWEST = -1e6
"""Rate of what is forgotten at once, 1/s."""


def growth_rates(loop: LinearLoop, cycle: Cycle, nominal_unit: float = 0.0) -> Floats:
    """The largest growth rates (RATES_SEARCHED,), 1/s, descending (`nominal_unit` as in `Lifted`)."""
    size = np.abs(np.linalg.eigvals(Lifted(loop, cycle, nominal_unit).monodromy()))
    return np.asarray(_largest(size[None], np.array([cycle.hyperperiod]))[0])


def _largest(moduli: Floats, hyperperiods: Floats) -> Floats:
    """Largest growth rates (N, RATES_SEARCHED) of moduli (N, rows)."""
    if not np.isfinite(moduli).all():
        moduli = np.where(np.isfinite(moduli), moduli, np.inf)  # beyond all numbers: it grows
    rates = np.full((moduli.shape[0], RATES_SEARCHED), SLOWEST)
    largest = np.sort(moduli, axis=1)[:, ::-1][:, :RATES_SEARCHED]
    with np.errstate(divide="ignore"):
        rates[:, : largest.shape[1]] = np.log(largest) / hyperperiods[:, None]
    return np.asarray(np.clip(rates, SLOWEST, -SLOWEST))


def _at_each(one: Callable[[float], Floats]) -> Rates:
    return lambda values: np.array([one(float(value)) for value in values]).reshape(-1, RATES_SEARCHED)


def of_scale_at_each(loop: LinearLoop, cycle: Cycle) -> Rates:
    """As `of_scale`, one factor after the other: for few of them, for which nothing more is compiled."""
    return _at_each(lambda factor: growth_rates(loop, cycle.scaled(factor), cycle.unit))


def of_scale(loop: LinearLoop, cycle: Cycle) -> Rates:
    """Rates over a factor on all periods and delays, in units of the scaled time."""

    def together(factors: Floats) -> Floats:
        from rthm_analysis.lifted.radii import moduli, stacked

        found = moduli(stacked([loop] * factors.size), cycle, cycle.unit * factors)
        return _largest(found, cycle.hyperperiod * factors)

    return together if loop.predictor is None else of_scale_at_each(loop, cycle)


def _as_known(spec: Spec, loop: LinearLoop, name: str, value: float) -> LinearLoop:
    """The loop when one of its times is another: a compensator knows the times, nothing else does."""
    return loop if loop.predictor is None else linear_loop(apply(spec, {f"timing.{name}": value}))


def of_delay(spec: Spec, loop: LinearLoop, name: str) -> Rates:
    """Rates over the value in s of one delay, beside which the link's own effects stay."""
    schedule = Schedule(spec)
    beside = schedule.links[name].beside_ns
    # What is faster than the spec says takes no more off than there is.
    least = max(0, -beside, -beside - schedule.motor_delay if name == "tau4" else 0) / NS

    step = schedule.delay_step(name) if loop.predictor is None and schedule.links[name].constant else 1

    @cache
    def within(steps: int, value: float | None) -> Floats:
        changed = schedule.copied()
        changed.links[name].delay_ns = max(0, steps * step - step // 2)
        cycle = commensurate(changed, EVENTS_IN_A_SEARCH, loop.history).cycle
        return growth_rates(loop if value is None else _as_known(spec, loop, name, value), cycle)

    def one(value: float) -> Floats:
        value = max(value, least)
        steps = -(-(beside + to_ns(value)) // step)
        return within(steps, None if loop.predictor is None else value)

    return _at_each(one)


def of_period(spec: Spec, loop: LinearLoop, name: str, lattice_ns: int) -> Rates:
    """Rates over one period in s, taken at the nearest multiple of `lattice_ns`."""
    schedule = Schedule(spec)

    @cache
    def at(number: int) -> Floats:
        changed = schedule.copied()
        setattr(changed, name, number * lattice_ns)
        cycle = commensurate(changed, EVENTS_IN_A_SEARCH, loop.history).cycle
        return growth_rates(_as_known(spec, loop, name, number * lattice_ns * 1e-9), cycle)

    return _at_each(lambda value: at(max(1, round(value * 1e9 / lattice_ns))))


def of_k_tot(loops: Callable[[float], LinearLoop], cycle: Cycle) -> Rates:
    """Rates over the logarithm of a factor on k_tot."""

    def one(logarithm: float) -> Floats:
        return growth_rates(loops(float(np.exp(logarithm))), cycle)

    def together(logarithms: Floats) -> Floats:
        from rthm_analysis.lifted.radii import moduli, stacked

        found = moduli(stacked([loops(float(np.exp(one))) for one in logarithms]), cycle)
        return _largest(found, np.full(logarithms.size, cycle.hyperperiod))

    return together if loops(1.0).predictor is None else _at_each(one)
