"""All scores in words: a Markdown page, and the same numbers as a dictionary."""

from __future__ import annotations

import os
import platform
from collections import Counter, defaultdict
from statistics import median
from typing import Any

Row = dict[str, Any]


def summary(rows: list[Row]) -> dict[str, Any]:
    """Return the headline numbers: counts as ``[right, of]``."""
    effect, clean, pair, retuned = (
        [r for r in rows if r["group"] == g] for g in ("effect", "clean", "pair", "retuned")
    )
    ratios = [r["held_out"] for r in effect if r.get("family") and r.get("held_out") is not None]
    return {
        "block": _count(effect, "block"),
        "family": _count(effect, "family"),
        "kind": _count(effect, "kind"),
        "among": _count(effect, "among"),
        "false_alarms": _count(clean, "alarm"),
        "both_of_a_pair": _count(pair, "both"),
        "retuned_covered": _count(retuned, "covered"),
        "held_out_within_1.3": [sum(q <= 1.3 for q in ratios), len(ratios)],
        "held_out_median": median(ratios) if ratios else None,
        "no_answer": [sum("error" in r for r in rows), len(rows)],
        "seconds_median": median(r["seconds"] for r in rows) if rows else None,
    }


def by_kind(rows: list[Row]) -> dict[str, dict[str, Any]]:
    """Return the same for every kind; links and sensors over all their members."""
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        if row["group"] == "effect":
            block, kind = row["concealed"][0]
            groups[f"{block.split('.')[0]} {kind}"].append(row)
    return {
        name: {k: _count(g, k) for k in ("block", "family", "kind", "among")} | {"wrong": _mistaken(g)}
        for name, g in sorted(groups.items())
    }


def _count(rows: list[Row], key: str) -> list[int]:
    return [sum(bool(r.get(key)) for r in rows), len(rows)]


def _mistaken(rows: list[Row]) -> dict[str, int]:
    """Return what was named where the kind is not right."""
    return dict(Counter(_named(r) for r in rows if not r.get("kind")))


def _named(row: Row) -> str:
    if "error" in row:
        return f"no answer ({row['error']})"
    return " + ".join(f"{b} {k}" for b, k in row["found"]) or row["verdict"]


def _share(count: list[int]) -> str:
    right, of = count
    return f"{right}/{of}" + (f" ({100 * right / of:.0f} %)" if of else "")


def machine() -> str:
    """Return the machine in words."""
    cores = f"{os.cpu_count()} cores ({platform.machine()})"
    return f"{cores}, Python {platform.python_version()}, {platform.system()}"


def markdown(header: dict[str, Any], rows: list[Row]) -> str:
    """Return the page."""
    lines = ["# Diagnosis on concealed cases", "", _made(header, rows), "", *_headline(summary(rows))]
    return "\n".join(
        lines + _kinds(rows) + _families(rows) + _sizes(rows) + _pairs(rows) + _alarms(rows) + LEGEND
    )


def _made(header: dict[str, Any], rows: list[Row]) -> str:
    return (
        f"Made {header['date']} on {header['machine']} by `python -m benchmarks.concealed`, "
        f"master seed {header['master']}, {len(rows)} of {header['cases']} cases. Tests, effects, loads "
        "and noise are drawn anew from that seed; noise is the contract's reference noise; a diagnosis sees "
        "the bag and the nominal spec."
    )


def _headline(s: dict[str, Any]) -> list[str]:
    lines = [
        ("block", "block", "95 %"),
        ("family", "family", "85 %"),
        ("kind", "kind", ""),
        ("kind, or named as indistinguishable", "among", ""),
        ("false alarms where nothing is missing", "false_alarms", "at most 2 %"),
        ("both of a pair", "both_of_a_pair", "70 %"),
        ("retuned, true value within two standard deviations", "retuned_covered", "90 %"),
        (
            "held-out error within 1.3 x of the true model's (family right)",
            "held_out_within_1.3",
            "100 %",
        ),
        ("no answer", "no_answer", "0"),
    ]
    out = ["| | counted | asked |", "|---|---|---|"]
    out += [f"| {words} | {_share(s[key])} | {asked} |" for words, key, asked in lines]
    if s["seconds_median"] is not None:
        out += [
            "",
            f"Median time of a diagnosis, start of the program included: {s['seconds_median']:.1f} s.",
        ]
    return [*out, ""]


def _kinds(rows: list[Row]) -> list[str]:
    out = ["## Every kind", "", "| kind | block | family | kind | instead |", "|---|---|---|---|---|"]
    for name, g in by_kind(rows).items():
        wrong = ", ".join(f"{k} x {n}" if n > 1 else k for k, n in g["wrong"].items())
        out.append(
            f"| {name} | {_share(g['block'])} | {_share(g['family'])} | {_share(g['kind'])} | {wrong} |"
        )
    return [*out, ""]


def _grouped(rows: list[Row], key: str, title: str) -> list[str]:
    groups: dict[Any, list[Row]] = defaultdict(list)
    for row in rows:
        if row["group"] == "effect":
            groups[row[key]].append(row)
    out = [f"## {title}", "", f"| {key.replace('_', ' ')} | block | family | kind |", "|---|---|---|---|"]
    for name, g in sorted(groups.items()):
        shares = " | ".join(_share(_count(g, k)) for k in ("block", "family", "kind"))
        out.append(f"| {name} | {shares} |")
    return [*out, ""]


def _families(rows: list[Row]) -> list[str]:
    return _grouped(rows, "true_family", "Families")


def _sizes(rows: list[Row]) -> list[str]:
    return _grouped(rows, "asked_size", "Sizes: share of the wire's force")


def _pairs(rows: list[Row]) -> list[str]:
    out = ["## Pairs", "", "| concealed | named |", "|---|---|"]
    for row in rows:
        if row["group"] == "pair":
            out.append(f"| {' + '.join(f'{b} {k}' for b, k in row['concealed'])} | {_named(row)} |")
    return [*out, ""]


def _alarms(rows: list[Row]) -> list[str]:
    out = ["## False alarms", ""]
    out += [f"- case {r['index']}: {_named(r)}" for r in rows if r.get("alarm")] or ["None."]
    return [*out, ""]


LEGEND = """## How it is counted

- Block, family and kind are right when exactly the true ones are named, no more and no fewer. Where no kind
  is named, the located blocks count. An extra delay of the motor and one of link.tau4 are the same thing.
- Families: friction (Coulomb, Stribeck, pulley), drag, stiffness (cubic, quadratic, hardening), contact (end
  stop, clearance, slack, backlash), hysteresis, memory (Maxwell, hidden mode, fluid memory, pulley inertia),
  load, motor dynamics (lag, second order, extra delay), motor limits (rate, saturation, quantisation), link,
  sensor, parameter.
- In a fifth of the cases the plant's parameters are uncertain, and off by about as much as the spec says;
  where nothing else is missing in such a case, `retuned` is no false alarm.
- Both of a pair are found when both families are named.
- The true model's held-out error is that of the noise-free motion against the recording.
""".splitlines()
