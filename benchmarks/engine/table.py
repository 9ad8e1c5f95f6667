"""The results as a page."""

from __future__ import annotations

from typing import Any

HEAD = """\
# Speed

{duration:g} s of the paper's loop with a row of the trajectory every {milliseconds:g} ms ({rows} rows): CPU
time, median of interleaved rounds, and as a ratio to a C event engine on the same work. Error: largest
difference of x1 from the same events in 50-digit arithmetic.

{date}, {machine}. Again: `python -m benchmarks.engine --out docs`.

| way | CPU | ratio to C | error of x1 |
|---|---|---|---|
"""
BEYOND = """
Loops beyond the paper's, by what they add, `simulate()` as a whole; the unit is still the paper's loop in C.

| loop | CPU | ratio |
|---|---|---|
"""


def _time(seconds: float | None) -> str:
    if seconds is None:
        return "-"
    return f"{seconds * 1e3:.3g} ms" if seconds < 1.0 else f"{seconds:.3g} s"


def _number(value: float | None, unit: str = "") -> str:
    return "-" if value is None else f"{value:.3g}{unit}"


def markdown(found: dict[str, Any]) -> str:
    """Page of the results that ``__main__`` writes."""
    rows = int(found["duration"] / found["sample"]) + 1
    text = HEAD.format(**found, milliseconds=found["sample"] * 1e3, rows=rows)
    for row in found["ways"]:
        if row["skipped"]:
            text += f"| {row['name']} | not measured: {row['skipped']} | | |\n"
        else:
            error = _number(row["error"], " m")
            text += f"| {row['name']} | {_time(row['cpu'])} | {_number(row['ratio'])} | {error} |\n"
    text += BEYOND
    for row in found["beyond"]:
        text += f"| {row['name']} | {_time(row['cpu'])} | {_number(row['ratio'])} |\n"
    return text
