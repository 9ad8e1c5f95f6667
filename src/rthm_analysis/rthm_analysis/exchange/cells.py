"""Cells of a text table as numbers, or as instants where they are dates and times of day."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from datetime import date
from functools import partial

import numpy as np

from rthm_analysis.exchange.columns import Column
from rthm_core.clock import NS
from rthm_core.errors import InputError, shown

MISSING = ("", "na", "n/a", "null", "none", "-", "nan")

DAY = 86_400 * NS
"""Nanoseconds of a day."""

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")

_INSTANT = re.compile(
    r"(?:(?:(?P<year>\d{4})[-/.](?P<month>\d\d?)[-/.](?P<day>\d\d?)"
    r"|(?P<first>\d\d?)(?P<sign>[./-])(?P<second>\d\d?)[./-](?P<last>\d{4}))(?:T|,?\s+))?"
    r"(?P<hour>\d\d?):(?P<minute>\d\d):(?P<seconds>\d\d)(?:[.,](?P<part>\d{1,9})\d*)?"
    r"\s*(?:Z|(?P<zone>[-+])(?P<east>\d\d):?(?P<further>\d\d))?"
)
"""A time of day, behind a date or by itself."""

_WHOLE = set(_INSTANT.groupindex) - {"sign", "zone", "part"}

MONTHS = 12


def has_decimal_comma(cells: Sequence[str]) -> bool:
    """Whether a number among the cells of a row has a comma before its fractional part."""
    return any(_DECIMAL_COMMA.fullmatch(cell) for cell in cells)


def is_known(cell: str, decimal: str) -> bool:
    """Whether a cell is a number or an instant."""
    return bool(cell) and cell.lower() not in MISSING and is_value(cell, decimal)


def is_value(cell: str, decimal: str) -> bool:
    """Whether a cell is a number, an instant, or a missing value."""
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return cell.lower() in MISSING or is_instant(cell)
    return True


def is_instant(cell: str) -> bool:
    """Whether a cell is a time of day, with a date or without."""
    return _INSTANT.fullmatch(cell) is not None


def read_column(
    path: str, name: str, unit: str, cells: Sequence[str], lines: Sequence[int], decimal: str
) -> Column:
    """Numbers (n,) of a column, NaN where a value is missing; whole ns and instants as integers.

    A column of words, such as remarks, has no value at all.

    Raises
    ------
    InputError
        A cell among numbers is something else; the sentence names its line.
    """
    timed = is_instant(cells[0])
    try:
        if timed or unit == "ns":
            return _nanoseconds(cells, timed=timed)
    except (ValueError, OverflowError):
        pass
    read = _instant if timed else partial(_number, decimal=decimal)
    try:
        return np.array([read(cell) for cell in cells], dtype=float)
    except ValueError:
        if not any(is_known(cell, decimal) for cell in cells):
            return np.full(len(cells), np.nan)
        row = next(k for k, cell in enumerate(cells) if not _can_be_read(read, cell))
        where = f"{path}, line {lines[row]}, column {name}: {shown(cells[row])}"
        if timed:
            raise InputError(f"{where} is not a time of day as above it; correct it.") from None
        raise InputError(
            f"{where} is not a number; correct it, or leave the cell empty when the value is not known."
        ) from None


def _can_be_read(read: Callable[[str], float], cell: str) -> bool:
    try:
        read(cell)
    except ValueError:
        return False
    return True


def _nanoseconds(cells: Sequence[str], *, timed: bool) -> Column:
    if not timed:
        return np.array([int(cell) for cell in cells], dtype=np.int64)
    stamps = np.array([_instant(cell) for cell in cells], dtype=np.int64)
    if stamps[0] < DAY:  # times of day alone begin anew at midnight
        stamps[1:] += DAY * np.cumsum(np.diff(stamps) < -DAY // 2)
    return stamps


def _instant(cell: str) -> int:
    """Nanoseconds of an instant since 1970, or since midnight where there is no date."""
    found = _INSTANT.fullmatch(cell)
    if found is None:
        raise ValueError(cell)
    whole = {key: int(found[key] or 0) for key in _WHOLE}
    east = (60 * whole["east"] + whole["further"]) * (-1 if found["zone"] == "-" else 1)
    seconds = 3600 * whole["hour"] + 60 * (whole["minute"] - east) + whole["seconds"]
    return _days(whole, found["sign"]) * DAY + seconds * NS + int((found["part"] or "0").ljust(9, "0"))


def _days(whole: dict[str, int], sign: str | None) -> int:
    """Days since 1970 of a date, 0 of none; with slashes the month comes first where it can."""
    if whole["year"]:
        when = date(whole["year"], whole["month"], whole["day"])
    elif whole["last"]:
        day, month = whole["first"], whole["second"]
        if sign == "/" and day <= MONTHS:
            day, month = month, day
        when = date(whole["last"], month, day)
    else:
        return 0
    return when.toordinal() - date(1970, 1, 1).toordinal()


def _number(cell: str, decimal: str) -> float:
    try:
        return float(cell.replace(decimal, ".") if decimal != "." else cell)
    except ValueError:
        if cell.lower() in MISSING:
            return float("nan")
        raise
