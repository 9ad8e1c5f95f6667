"""``rthm timing``: delays, jitter, lost and late samples of a recording."""

from __future__ import annotations

from typing import Any

from rthm_bringup.cli.options import Bag, Effects, Json, SpecOfBag, recording_of

EXAMPLES = ("rthm timing out/bag",)


def verb(bag: Bag, spec: SpecOfBag = None, effects: Effects = None, json: Json = None) -> int:
    """Measure delays, clocks and losses of a recorded test."""
    from rthm_analysis.timing import timing_of
    from rthm_bringup.cli.output import put

    recording = recording_of(bag, effects, spec)
    result: dict[str, Any] = timing_of(recording, recording.spec).as_dict()
    result["notes"] = [*recording.notes, *result["notes"]]
    put(result, [*_lines(result), *recording.notes], json)
    return 0


def _lines(result: dict[str, Any]) -> list[str]:
    from rthm_bringup.cli.output import table

    links = [("link", "age mean", "excess p99", "excess max", "lost", "late", "uses")]
    for name, link in result["links"].items():
        age, excess = link["age"], link["excess"]
        numbers = (_ms(age["mean"]), _ms(excess["p99"]), _ms(excess["max"]))
        links.append((name, *numbers, str(link["lost"]), str(link["late"]), str(link["count"])))
    clocks = [("clock", "period mean", "period p99", "missed")]
    for name, clock in result["clocks"].items():
        clocks.append((name, _ms(clock["period_mean"]), _ms(clock["period_p99"]), str(clock["missed"])))
    return [*table(links), "", *table(clocks), *_hosts(result["hosts"]), *_stalls(**result["held_up"])]


def _hosts(hosts: dict[str, Any]) -> list[str]:
    from rthm_bringup.cli.output import table

    if not hosts:
        return []
    rows = [("clock of", "ahead by", "least", "most", "+-", "drift")]
    for name, host in hosts.items():
        offset, least, most, unsure = (_ms(host[key]) for key in ("offset", "least", "most", "uncertainty"))
        rows.append((name, offset, least, most, unsure, f"{host['drift'] * 1e6:.0f} ppm"))
    return ["", *table(rows), "ages are corrected by these"]


def _stalls(count: int, share: float, longest: float) -> list[str]:
    if not count:
        return []
    how = f"{count} times, for {100.0 * share:.1f} % of the test and up to {_ms(longest)}"
    return ["", f"host stalls: {how} (excess without them: excess_undisturbed of --json)"]


def _ms(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds * 1e3:.3f} ms"
