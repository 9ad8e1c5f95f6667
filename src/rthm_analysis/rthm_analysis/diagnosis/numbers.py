"""Numbers as a test engineer writes them: with the digits that they deserve, or as a bound."""

from __future__ import annotations

import math
import re

from rthm_analysis.diagnosis.criteria.words import (
    BOUND_STD_RATIO,
    BOUND_STDS,
    EXACT_STD_DIGITS,
    PERCENT_MOST_DECIMALS,
    SECOND_DIGIT_BELOW,
    SMALLER_UNIT_BELOW,
    UNTOLD_STD_RATIO,
    WITHOUT_POWER_OF_TEN,
)

NOT_DETERMINED = "an amount that this recording does not determine"

SMALLER = {"m": ("mm", "um"), "s": ("ms", "us")}
"""Units of a thousandth and a millionth."""


def number(value: float, std: float, unit: str, *, signed: bool = False, size: float = 0.0) -> str:
    """A value that was found: ``0.1183 +- 0.0021 N``, ``at most 0.4 mm``, or its digits where it is exact.

    Parameters
    ----------
    value, std : float
        In `unit`; `std` is one standard deviation, and NaN where it is not known.
    unit : str
        SI; empty or ``1`` without one.
    signed : bool
        Whether the true value may be negative.
    size : float
        Size beside which a bound says something, however small the value itself is.

    Examples
    --------
    >>> number(0.11834, 0.0021, "N")
    '0.1183 +- 0.0021 N'
    >>> number(1e-4, 1.5e-4, "m")
    'at most 0.4 mm'
    >>> number(40.5, 1e-9, "N/m")
    '40.5 N/m'
    """
    if not math.isfinite(value):
        return NOT_DETERMINED
    if math.isnan(std):
        return with_unit(value, unit)
    for spread, digits in EXACT_STD_DIGITS.items():
        if std <= spread * abs(value):
            return with_unit(value, unit, digits)
    if std > BOUND_STD_RATIO * abs(value):
        return _bound(value, std, unit, signed=signed or value < 0.0, size=size)
    factor, unit = _scale(value, unit)
    return f"{_with_spread(value * factor, std * factor)}{_suffix(unit)}"


def with_unit(value: float, unit: str, digits: int = 3) -> str:
    """A number with so many digits and its unit: ``0.4 mm``."""
    factor, unit = _scale(value, unit)
    return f"{bare(value * factor, digits)}{_suffix(unit)}"


def bare(value: float, digits: int = 3) -> str:
    """A number without unit, trailing zeros or more digits than asked for: ``0.4``."""
    rounded = float(f"{value:.{digits}g}")
    if rounded and not WITHOUT_POWER_OF_TEN[0] <= abs(rounded) < WITHOUT_POWER_OF_TEN[1]:
        return re.sub(r"e([-+])0*", r"e\1", f"{rounded:.{digits}g}").replace("e+", "e")
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(rounded)))) if rounded else 0
    text = f"{rounded:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def percent(part: float, digits: int = 2) -> str:
    """A part of something: ``93 %``, and ``99.98 %`` where it is nearly all."""
    size = 100.0 * part
    if not math.isfinite(size):
        return "not known"
    rest = abs(100.0 - size)
    if not 0.0 < rest < 1.0:
        return f"{bare(size, digits)} %"
    decimals = min(-math.floor(math.log10(rest)), PERCENT_MOST_DECIMALS)
    return f"{bare(round(size, decimals), max(digits, decimals + 3))} %"


def instants(first: float, last: float) -> tuple[str, str]:
    """Begin and end of a stretch of time, in s, with digits that tell them apart.

    Examples
    --------
    >>> instants(7.6634, 8.126)
    ('7.663 s', '8.126 s')
    >>> instants(0.000123, 0.001456)
    ('0.00012 s', '0.00146 s')
    """
    decimals = max(3, 2 - math.floor(math.log10(last - first))) if last > first else 6
    return f"{first:.{decimals}f} s", f"{last:.{decimals}f} s"


def _bound(value: float, std: float, unit: str, *, signed: bool, size: float) -> str:
    """What is known of a value that the recording hardly determines."""
    if not math.isfinite(std) or (std > UNTOLD_STD_RATIO * abs(value) > 0.0 and std > abs(size)):
        return NOT_DETERMINED
    reach = BOUND_STDS * std
    if not signed:
        return f"at most {with_unit(value + reach, unit, 2)}"
    factor, unit = _scale(max(abs(value - reach), abs(value + reach)), unit)
    low, high = (bare(factor * one, 2) for one in (value - reach, value + reach))
    return f"between {low} and {high}{_suffix(unit)}"


def _scale(value: float, unit: str) -> tuple[float, str]:
    """Factor and unit in which a size is easy to read."""
    for step, smaller in reversed(list(enumerate(SMALLER.get(unit, ()), 1))):
        if WITHOUT_POWER_OF_TEN[0] * 1e-3**step < abs(value) < SMALLER_UNIT_BELOW * 1e-3 ** (step - 1):
            return 1e3**step, smaller
    return 1.0, unit


def _with_spread(value: float, std: float) -> str:
    """Value and standard deviation to the same decimal place."""
    power = math.floor(math.log10(std))
    places = 1 - power if std / 10.0**power < SECOND_DIGIT_BELOW else -power
    if WITHOUT_POWER_OF_TEN[0] <= abs(value) < WITHOUT_POWER_OF_TEN[1]:
        return f"{value:.{max(places, 0)}f} +- {std:.{max(places, 0)}f}"
    shift = math.floor(math.log10(abs(value)))
    scale, shown = 10.0**-shift, max(places + shift, 0)
    return f"({value * scale:.{shown}f} +- {std * scale:.{shown}f})e{shift}"


def _suffix(unit: str) -> str:
    return "" if unit in ("", "1") else f" {unit}"
