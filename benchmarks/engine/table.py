"""The results as a page."""

from __future__ import annotations

from typing import Any

HEAD = """\
# Speed

{duration:g} s of the paper's loop with a row of the trajectory every {milliseconds:g} ms ({rows} rows): CPU
time on one thread, median of interleaved rounds, and as a ratio to a C event engine on the same work, median
of the ratios within each round. Error: largest difference of x1 from the same events in 50-digit arithmetic.

{date}, {machine}. Again: `python -m benchmarks.engine --out docs`.

| way | CPU | ratio to C | error of x1 |
|---|---|---|---|
"""
BEYOND = """
Loops beyond the paper's, by what they add, `simulate()` as a whole; the unit is still the paper's loop in C.
Error, for loops that are not linear: largest difference of x1 from the engine that takes any loop, which
allows a step an error of 1e-11 of the largest motion.

| loop | CPU | ratio | error of x1 |
|---|---|---|---|
"""

TWINS = """
Kernels of linear loops, on prepared matrices and rows, beside a twin in C that executes the same program over
the same matrices and is compiled for the numbers of states of the loop. Difference: largest of any row of the
plant.

| loop | kernel | ratio to its twin | difference |
|---|---|---|---|
"""

DERIVATIVES = """
`sensitivities` to all parameters, and as a ratio to `simulate` of the same loop: energies counted in both,
and in neither.

| loop | parameters | with energies | ratio | without | ratio |
|---|---|---|---|---|---|
"""

SCALE = """
Many loops (`simulate_many`), a long loop (`simulate_blocks`), and the start of the program:

| what | measured |
|---|---|
| one of 1024 loops of {duration:g} s side by side, a row every second | {per_loop}, {ratio} of C |
| one of 1024 loops of {duration:g} s with delays of their own, a row every second | {own}, {own_ratio} of C |
| one of 1024 stability checks | {check}, {check_ratio} of {duration:g} s in C |
| an hour of the loop with energies, in blocks | {hour} CPU, {added:.0f} MB more at the peak |
| `rthm simulate` for {duration:g} s, first use after installation (compiles) | {first} CPU |
| `rthm simulate` for {duration:g} s, every later start | {later} CPU |
| `rthm sweep` of {loops} loops of {duration:g} s on two cores, start included | {sweep}, {sweep_cpu} CPU |
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
        error = "" if row["error"] is None else _number(row["error"], " m")
        text += f"| {row['name']} | {_time(row['cpu'])} | {_number(row['ratio'])} | {error} |\n"
    text += TWINS
    for row in found["twins"]:
        text += (
            f"| {row['name']} | {_time(row['cpu'])} | {_number(row['ratio'])} | {_number(row['error'])} |\n"
        )
    text += DERIVATIVES
    for row in found["derivatives"]:
        counted = f"{_time(row['counting_sensitive'])} | {_number(row['counting_sensitive_ratio'])}"
        plain = f"{_time(row['sensitive'])} | {_number(row['sensitive_ratio'])}"
        text += f"| {row['name']} | {row['parameters']} | {counted} | {plain} |\n"
    scale = found["scale"]
    return text + SCALE.format(
        duration=found["duration"],
        per_loop=_time(scale["per_loop"]),
        ratio=_number(scale.get("per_loop_ratio")),
        own=_time(scale["own_delays"]),
        own_ratio=_number(scale.get("own_delays_ratio")),
        check=_time(scale["check"]),
        check_ratio=_number(scale.get("check_ratio")),
        hour=_time(scale["hour"]),
        added=scale["hour_added_mb"],
        first=_time(scale["first_start"]),
        later=_time(scale["later_start"]),
        loops=scale["sweep_loops"],
        sweep=_time(scale["sweep"]),
        sweep_cpu=_time(scale["sweep_cpu"]),
    )
