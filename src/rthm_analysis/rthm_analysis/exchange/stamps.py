"""When samples were taken: from a column of the file, or from a rate; and what is odd about it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.exchange.columns import Columns
from rthm_analysis.exchange.mapping import Wanted
from rthm_analysis.exchange.units import FACTORS, factor
from rthm_core.clock import NS
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.compiled import Flags, Floats, Integers

USUAL_NAMES = ("t", "time", "zeit", "temps", "timestamp", "stamp", "seconds")

_WITH_UNIT = re.compile(r"(?P<name>.+)[ _](?P<unit>s|ms|us|ns)")

UNEVEN = 0.01
"""Part of the period by which steps may differ and still count as even."""

SLOW = 2.0
"""Seconds from sample to sample above which the unit of time is probably another one."""

LATEST = 9.2e9
"""Seconds that nanoseconds can count."""


def stamps_of(columns: Columns, wanted: Wanted, count: int) -> tuple[Integers, list[str]]:
    """Stamps (count,) in ns, and remarks on them, one sentence each.

    Raises
    ------
    InputError
        There is no time, or it is not finite or does not increase.
    """
    if wanted.rate is not None:
        return _even(1.0 / wanted.rate, count), []
    name = wanted.time or _usual(columns)
    if name is None:
        if columns.period is None:
            raise InputError(
                f"{columns.source} has the columns {', '.join(columns.values)}, and none is known to be the "
                f"time; say --time COLUMN, or --rate HZ when there is none."
            )
        return _even(columns.period, count), []
    if name not in columns.values:
        raise no_column(columns, name)
    stamps, notes = _absolute(columns, wanted, name)
    if stamps.size != count:
        raise InputError(
            f"{columns.source}: {name} has {stamps.size} values, but the signals have {count}; "
            f"name a column that belongs to them."
        )
    _check_order(columns, name, stamps)
    return stamps, [*notes, *_remarks(stamps)]


def no_column(columns: Columns, name: str) -> InputError:
    """Return the sentence about a column that is not there."""
    return InputError(
        f"{columns.source} has no column {name!r}, but {', '.join(columns.values)}; take one of these."
    )


def _usual(columns: Columns) -> str | None:
    """The column of the time: one with a usual name, as ``t_ms``, else the only one in a unit of time."""
    usual = next((name for name in columns.values if _base(name) in USUAL_NAMES), None)
    timed = [name for name in columns.values if columns.units.get(name) in FACTORS["s"]]
    return usual or (timed[0] if len(timed) == 1 else None)


def _base(name: str) -> str:
    """A name in small letters, without a unit of time behind it."""
    found = _WITH_UNIT.fullmatch(name.lower())
    return found["name"] if found else name.lower()


def _unit_of(columns: Columns, name: str) -> str:
    """Unit of time that a file states, in a heading or behind a usual name; else s."""
    found = _WITH_UNIT.fullmatch(name.lower())
    behind = found["unit"] if found and found["name"] in USUAL_NAMES else "s"
    return columns.units.get(name, behind)


def _even(period: float, count: int) -> Integers:
    """Instants k * period, none of which is rounded twice."""
    return np.asarray(np.rint(np.arange(count) * (period * NS)).astype(np.int64))


def _absolute(columns: Columns, wanted: Wanted, name: str) -> tuple[Integers, list[str]]:
    values, notes = columns.values[name], []
    unit = wanted.units.get("time") or _unit_of(columns, name)
    if wanted.time is None:
        notes.append(f"the column {name} is taken as the time in {unit}.")
    if unit == "ns" and values.dtype == np.int64:
        stamps = np.asarray(values, dtype=np.int64)
    else:
        stamps = _rounded(columns, name, np.asarray(values, dtype=float) * factor(unit, "s", "time"))
    if stamps.size and stamps[0] < 0:
        notes.append(f"time begins at {stamps[0] / NS:g} s: it is counted from there.")
        stamps = stamps - stamps[0]
    return stamps, notes


def _rounded(columns: Columns, name: str, seconds: Floats) -> Integers:
    wrong = np.flatnonzero(~(np.abs(seconds) < LATEST))
    if wrong.size:
        raise InputError(
            f"{columns.source}: the time {name} is {seconds[wrong[0]]} s in sample {wrong[0] + 1}, but must "
            f"be a number below {LATEST:g}; correct it, or say --rate HZ instead."
        )
    return np.rint(seconds * NS).astype(np.int64)


def _check_order(columns: Columns, name: str, stamps: Integers) -> None:
    back = np.flatnonzero(np.diff(stamps) <= 0)
    if back.size:
        k = int(back[0])
        raise InputError(
            f"{columns.source}: the time {name} goes from {stamps[k] / NS:.9g} s to {stamps[k + 1] / NS:.9g} "
            f"s in sample {k + 2}, but must increase; sort the file, or say --rate HZ when the column is not "
            f"the time."
        )


def are_gaps(steps: Integers) -> Flags:
    """Which steps of time (n,) lack samples."""
    return np.asarray(steps > 1.5 * np.median(steps))


def _remarks(stamps: Integers) -> Sequence[str]:
    steps = np.diff(stamps)
    if not steps.size:
        return []
    period = float(np.median(steps))
    remarks = []
    gaps = are_gaps(steps)
    if gaps.any():
        remarks.append(
            f"gaps in time: {int(gaps.sum())}, the longest {steps.max() / NS:.4g} s: samples are missing."
        )
    spread = float(np.abs(steps[~gaps] - period).max()) if (~gaps).any() else 0.0
    if spread > UNEVEN * period:
        remarks.append(
            f"steps of time differ by up to {spread / NS:.2g} s from {period / NS:.6g} s: kept as they are; "
            f"if only digits are missing, --rate {NS / period:.6g} takes even ones."
        )
    if period > SLOW * NS:
        remarks.append(f"{period / NS:.4g} s lie between samples: is the unit right (--unit time=ms)?")
    return remarks
