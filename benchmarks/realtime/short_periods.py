"""All clocks at one short period: a run, and a bare rclpy loop of the same messages, in turn."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from benchmarks.realtime.bare import CLOCKS, missed_ticks
from benchmarks.realtime.judge import Line
from benchmarks.realtime.measure import run

from rthm_core.spec import apply, shipped_spec, write_spec

PERIODS = (0.001, 0.0005)
"""Periods of all clocks, s; the first one is asked for, the others are told."""

ROUNDS = 3
"""How often each way is run, in turn, so that all have their share of what the machine does meanwhile."""

WAYS: dict[str, tuple[str, ...]] = {"composed": ("--compose",), "apart": ()}
"""Ways to run a test, and their options."""


def with_short_periods(spec: str, duration: float, folder: Path) -> dict[str, Any]:
    """Missed ticks of all clocks, by period in s: ``bare``, and by way to run."""
    return {"periods": {str(period): _missed(spec, period, duration, folder) for period in PERIODS}}


def judge_short_periods(figures: dict[str, Any]) -> list[Line]:
    """Lines about `with_short_periods`: at the first period no more is missed than by a bare loop."""
    lines = []
    for period, found in figures["periods"].items():
        asked = float(period) == PERIODS[0]
        for way in WAYS:
            met = found[way] <= found["bare"] or not asked or way != "composed"
            short = found["cut_short"][way]
            ended = f"; {short} of {ROUNDS} runs ended early, with all their ticks missed" if short else ""
            lines.append(
                Line(
                    f"ticks missed at {1e3 * float(period):g} ms, {way}",
                    f"{found[way]} of {found['ticks']}; bare {found['bare']}{_ratio(found, way)}{ended}",
                    "no more than bare" if asked and way == "composed" else "told",
                    met,
                )
            )
    return lines


def _ratio(found: dict[str, Any], way: str) -> str:
    return f", ratio {found[way] / found['bare']:.2f}" if found["bare"] else ""


def _missed(spec: str, period: float, duration: float, folder: Path) -> dict[str, Any]:
    """Sums over all rounds; of a run that ended early all ticks count as missed."""
    test = apply(shipped_spec(spec), {f"timing.{clock}": period for clock in ("td1", "td2", "td3")})
    file = folder / f"{period}.yaml"
    file.write_text(write_spec(test))
    ticks = CLOCKS * round(duration / period)
    found: dict[str, Any] = {"ticks": ROUNDS * ticks, "bare": 0} | dict.fromkeys(WAYS, 0)
    found["cut_short"] = dict.fromkeys(WAYS, 0)
    for number in range(ROUNDS):
        found["bare"] += missed_ticks(period, duration)
        for way, options in WAYS.items():
            try:
                told = run(str(file), duration, folder / f"{period}-{way}-{number}", *options)
                found[way] += told["missed_deadlines"]
            except RuntimeError as error:
                found[way] += ticks
                found["cut_short"][way] += 1
                print(f"{way}: {error}", file=sys.stderr, flush=True)
        print(f"{1e3 * period:g} ms, round {number + 1}: {found}", file=sys.stderr, flush=True)
    return found
