"""A comparison as tables: rows of text, the heading first. Terminal and page show the same."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from rthm_analysis.comparison.against import Against
from rthm_analysis.comparison.comparison import Comparison
from rthm_analysis.comparison.difference import NAUGHT, Difference, part
from rthm_analysis.comparison.lateness import Estimate
from rthm_analysis.comparison.tracking import Tracking
from rthm_analysis.diagnosis.numbers import number, with_unit

Row = tuple[str, ...]

UNKNOWN = "-"
EXACT_PERCENT = 1e-7
"""Change below which there is none, %."""

BOUND = 1e12
"""Size from which no number is told, SI."""

EXACT_S = 1e-9
"""Time below which there is none, s."""


def difference_rows(against: Against) -> list[Row]:
    """Motion and forces of a test against the reference: by signal, size, difference, delay, amplitude."""
    head = ("signal", "rms", "differs by", "at most", "late by", "amplitude", "left over")
    return [head, *(_difference(one) for one in against.judged.values())]


def _difference(one: Difference) -> Row:
    late = one.lateness
    return (
        one.name,
        size(one.size, one.unit),
        part(one.far),
        size(one.largest if one.largest > NAUGHT * one.size else 0.0, one.unit),
        seconds(late.delay),
        _change(late.gain),
        part(late.rest),
    )


def energy_rows(comparison: Comparison) -> list[Row]:
    """By term, energy at the end of every test and the damper that it is; then E_err over the largest
    E_total. Terms that are zero in all tests are left out.
    """
    balances = [one.balance for one in comparison.told]
    rows = [
        *_terms([one.at_end for one in balances], "", "J"),
        *_terms([one.damping for one in balances], " as a damper", "N s/m"),
    ]
    error = ("energy error", *(part(one.error) for one in balances))
    return [("energy", *_names(comparison)), *rows, error] if rows else []


def _terms(tests: Sequence[dict[str, float]], words: str, unit: str) -> Iterator[Row]:
    """One row for each term that is more than the arithmetic's in one of the tests."""
    known = [_without_naught(one) for one in tests]
    for term in dict.fromkeys(term for one in tests for term in one):
        values = [one.get(term, math.nan) for one in known]
        if any(values):
            yield (term + words, *(size(value, unit) for value in values))


def _without_naught(terms: dict[str, float]) -> dict[str, float]:
    """Terms of one test, those zero that are nothing beside the largest."""
    least = NAUGHT * max(map(abs, terms.values()), default=0.0)
    return {name: value if abs(value) > least else 0.0 for name, value in terms.items()}


def tracking_rows(comparison: Comparison) -> list[Row]:
    """What actuators of every test followed, and how well."""
    head = ("tracking", "test", "J1", "J2", "J3", "FEI amplitude", "FEI delay", "TI")
    rows = [
        _tracking(name, one)
        for name, told in zip(_names(comparison), comparison.told, strict=True)
        for one in told.trackings
    ]
    return [head, *rows] if rows else []


def _tracking(name: str, one: Tracking) -> Row:
    index = one.evaluation
    return (
        f"{one.got} after {one.wanted}",
        name,
        _time(one.delay),
        part(one.nrmse),
        part(one.peak),
        size(index.amplitude, "", 4),
        _time(index.delay),
        size(one.indicator, f"{one.unit}^2"),
    )


def delay_rows(comparison: Comparison) -> list[Row]:
    """Effective delay of every link, and of command to motion, in every test."""
    every = [one.delays for one in comparison.told]
    ways = list(dict.fromkeys(way for one in every for way in one))
    rows = [(way, *(seconds(one[way]) if way in one else UNKNOWN for one in every)) for way in ways]
    return [("effective delay", *_names(comparison)), *rows] if rows else []


def _names(comparison: Comparison) -> list[str]:
    """What tests are called in headings: by the last part of their names where these are different."""
    names = [one.motion.name for one in comparison.told]
    short = {name: Path(name).name for name in names}
    return [short[name] if len(set(short.values())) == len(short) else name for name in names]


def size(value: float, unit: str, digits: int = 3) -> str:
    """A value with its unit; a dash where it is not known, no number where it leaves every bound."""
    if abs(value) > BOUND:
        return "boundless"
    return with_unit(value + 0.0, unit, digits) if math.isfinite(value) else UNKNOWN


def seconds(estimate: Estimate) -> str:
    """A time with its standard deviation."""
    if not math.isfinite(estimate.value):
        return UNKNOWN
    if abs(estimate.value) < EXACT_S and not estimate.std > EXACT_S:
        return "0 ms"
    return number(estimate.value, estimate.std, "s", signed=True, size=math.inf)


def _time(value: float) -> str:
    """A time whose uncertainty is not known."""
    return seconds(Estimate(value, math.nan))


def _change(gain: Estimate) -> str:
    """Amplitude error in per cent with its standard deviation."""
    if not math.isfinite(gain.value):
        return UNKNOWN
    change, std = 100.0 * (gain.value - 1.0), 100.0 * gain.std
    if abs(change) < EXACT_PERCENT and not std > EXACT_PERCENT:
        return "0 %"
    return number(change, std, "%", signed=True, size=math.inf)
