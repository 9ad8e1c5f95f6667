"""Terms of a force that acts in an interval alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    CURVE_GAIN,
    CURVE_KNOTS,
    PLAIN_LEFT_RATIO,
    WITHIN_PLACES,
    WITHIN_REFINED,
    WITHIN_STEP_SHARE,
    WITHIN_STEPS,
)
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.missing.features import NOTHING, Curve, feature_of, knots
from rthm_analysis.diagnosis.missing.formulas import each_fitted_to, fitted_to, shown_by
from rthm_analysis.diagnosis.missing.shapes import WITHIN, Shape
from rthm_analysis.diagnosis.missing.terms import Term


def acting_within(regression: Regression, interval: tuple[float, float]) -> tuple[Term, ...]:
    """The term that explains most of a force that acts in an interval, s, alone; none where nothing does.

    What it depends on there is looked for with the interval given: a force that comes and goes shows in no
    curve over the motion of the whole recording.
    """
    found = [one for site in range(len(regression.sites)) for one in _at_site(regression, interval, site)]
    found.sort(key=lambda one: -one.gain)
    plain = [one for one in found if len(one.within) == len(interval)]
    best = dict.fromkeys([*plain[:WITHIN_REFINED], *found[:WITHIN_REFINED]])
    refined = each_fitted_to(regression, best, WITHIN_STEPS)
    return tuple(_elsewhere(regression, one) for one in _fewest_numbers(regression, refined))


def _at_site(regression: Regression, interval: tuple[float, float], site: int) -> Iterator[Term]:
    """Terms that act at a site in an interval, with the gain that each has within its free curve."""
    at = regression.along(site)
    inside = (at.t > interval[0]) & (at.t < interval[1])
    step = WITHIN_STEP_SHARE * (interval[1] - interval[0])
    gate = Term(regression.sites[site].name, "1", (("t", Shape(WITHIN, interval, (step, step))),))
    for carrier, variable in (("1", "x"), ("1", "v"), ("sign(v)", "v"), ("1", "load")):
        values = at._asdict()[variable]
        if not np.any(values[inside]):
            continue
        own = replace(gate, carrier=carrier)
        places = knots(values[inside], CURVE_KNOTS) if carrier == "1" else NOTHING
        fit = regression.fit(feature_of(at, Curve(own.with_values, variable, places)), site)
        shown = [] if fit is None else shown_by(fit)
        yield from (replace(own, shapes=(*gate.shapes, *one.shapes), gain=one.gain) for one in shown)


def _elsewhere(regression: Regression, term: Term) -> Term:
    """The term with its interval begun or ended where that explains more: no slope leads there."""
    begin, end = term.within[:2]
    shares = np.linspace(0.0, 1.0, WITHIN_PLACES + 2)[1:-1]
    for which in (1, 0):
        ways = [term.moved(_with(term.within, which, begin + share * (end - begin))) for share in shares]
        term = max([term, *each_fitted_to(regression, ways, 0)], key=lambda one: one.gain)
    return fitted_to(regression, term, WITHIN_STEPS)


def _with(numbers: tuple[float, ...], which: int, value: float) -> tuple[float, ...]:
    return (*numbers[:which], value, *numbers[which + 1 :])


def excess_of(regression: Regression) -> float:
    """Squared error above the noise that a model leaves, in units of the noise."""
    nothing = regression.normal(np.empty((0, regression.left.size)))
    return 0.0 if nothing is None else float(nothing.left_out().sum() - nothing.count.sum())


def _fewest_numbers(regression: Regression, terms: list[Term]) -> tuple[Term, ...]:
    """The term with the fewest numbers that leaves hardly more than the best one; none of none."""
    if not terms:
        return ()
    whole = excess_of(regression)
    allowed = PLAIN_LEFT_RATIO * max(whole - max(one.gain for one in terms), 0.0)
    good = [one for one in terms if whole - one.gain <= max(allowed, CURVE_GAIN)]
    return (min(good or terms, key=lambda one: (len(one.within), -one.gain)),)
