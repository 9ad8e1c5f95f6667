"""All scores in words: a Markdown page, and the same numbers as a dictionary."""

from __future__ import annotations

import os
import platform
from collections import Counter, defaultdict
from collections.abc import Iterable
from statistics import median
from typing import Any

Row = dict[str, Any]


def summary(rows: list[Row]) -> dict[str, Any]:
    """Return the headline numbers: counts as ``[right, of]``."""
    effect, clean, pair, triple, retuned = (
        [r for r in rows if r["group"] == g] for g in ("effect", "clean", "pair", "triple", "retuned")
    )
    ratios = [r["held_out"] for r in effect if r.get("family") and r.get("held_out") is not None]
    return {
        "block": _count(effect, "block"),
        "family": _count(effect, "family"),
        "kind": _count(effect, "kind"),
        "among": _count(effect, "among"),
        "false_alarms": _count(clean, "alarm"),
        "both_of_a_pair": _count(pair, "both"),
        "all_of_a_triple": _count(triple, "both"),
        "values": summed(r["values"] for r in rows if "values" in r),
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


def summed(counts: Iterable[list[int]]) -> list[int]:
    """Return the sum of counts ``[right, of]``."""
    both = list(counts)
    return [sum(c[0] for c in both), sum(c[1] for c in both)]


def numbers(header: Row, rows: list[Row]) -> dict[str, Any]:
    """Return all that the page shows."""
    several = [r for r in rows if r["group"] in ("pair", "triple")]
    return header | {
        "done": len(rows),
        "summary": summary(rows),
        "kinds": by_kind(rows),
        "families": _grouped(rows, "true_family"),
        "sizes": _grouped(rows, "asked_size"),
        "several": [[" + ".join(f"{b} {k}" for b, k in r["concealed"]), _named(r)] for r in several],
        "alarms": [f"case {r['index']}: {_named(r)}" for r in rows if r.get("alarm")],
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


def share(count: list[int]) -> str:
    """Return a count in words."""
    right, of = count
    return f"{right}/{of}" + (f" ({100 * right / of:.0f} %)" if of else "")


def machine() -> str:
    """Return the machine in words."""
    cores = f"{os.cpu_count()} cores ({platform.machine()})"
    return f"{cores}, Python {platform.python_version()}, {platform.system()}"


def markdown(n: dict[str, Any]) -> str:
    """Return the first part of the page, from its numbers."""
    lines = ["## First part: kinds of the library", "", _made(n), "", *_headline(n["summary"])]
    lines += _kinds(n["kinds"])
    lines += _table(n["families"], "true family", "Families")
    lines += _table(n["sizes"], "asked size", "Sizes: share of the wire's force")
    lines += ["### Pairs and triples", "", "| concealed | named |", "|---|---|"]
    lines += [f"| {hidden} | {named} |" for hidden, named in n["several"]]
    lines += ["", "### False alarms", "", *([f"- {a}" for a in n["alarms"]] or ["None."]), ""]
    return "\n".join(lines + LEGEND)


def _made(n: dict[str, Any]) -> str:
    return (
        f"Made {n['date']} on {n['machine']} by `python -m benchmarks.concealed`, "
        f"master seed {n['master']}, {n['done']} of {n['cases']} cases. Tests, effects, loads "
        "and noise are drawn anew from that seed; noise is the contract's reference noise; a diagnosis sees "
        "the bag and the nominal spec."
    )


def _headline(s: dict[str, Any]) -> list[str]:
    lines = [
        ("block", "block", "97 %"),
        ("family", "family", "96 %"),
        ("kind", "kind", ""),
        ("kind, or named as indistinguishable", "among", ""),
        ("false alarms where nothing is missing", "false_alarms", "at most 2 %"),
        ("both of a pair", "both_of_a_pair", "90 %"),
        ("all of a triple", "all_of_a_triple", "70 %"),
        ("parameters of rightly named kinds within two standard deviations", "values", "90 %"),
        ("retuned, true value within two standard deviations", "retuned_covered", "90 %"),
        (
            "held-out error within 1.3 x of the true model's (family right)",
            "held_out_within_1.3",
            "100 %",
        ),
        ("no answer", "no_answer", "0"),
    ]
    out = ["| | counted | asked |", "|---|---|---|"]
    out += [f"| {words} | {share(s[key])} | {asked} |" for words, key, asked in lines]
    if s["seconds_median"] is not None:
        out += [
            "",
            f"Median time of a diagnosis, start of the program included: {s['seconds_median']:.1f} s.",
        ]
    return [*out, ""]


def _kinds(kinds: dict[str, Any]) -> list[str]:
    out = ["### Every kind", "", "| kind | block | family | kind | instead |", "|---|---|---|---|---|"]
    for name, g in kinds.items():
        wrong = ", ".join(f"{k} x {n}" if n > 1 else k for k, n in g["wrong"].items())
        out.append(f"| {name} | {share(g['block'])} | {share(g['family'])} | {share(g['kind'])} | {wrong} |")
    return [*out, ""]


def _grouped(rows: list[Row], key: str) -> dict[str, dict[str, list[int]]]:
    groups: dict[Any, list[Row]] = defaultdict(list)
    for row in rows:
        if row["group"] == "effect":
            groups[row[key]].append(row)
    names = ("block", "family", "kind")
    return {str(name): {k: _count(g, k) for k in names} for name, g in sorted(groups.items())}


def _table(groups: dict[str, dict[str, list[int]]], head: str, title: str) -> list[str]:
    out = [f"### {title}", "", f"| {head} | block | family | kind |", "|---|---|---|---|"]
    out += [f"| {name} | {' | '.join(share(c) for c in g.values())} |" for name, g in groups.items()]
    return [*out, ""]


LEGEND = """### How it is counted

- Block, family and kind are right when exactly the true ones are named, no more and no fewer. Where no kind
  is named, the located blocks count. An extra delay of the motor and one of link.tau4 are the same thing.
- Families: friction (Coulomb, Stribeck, pulley), drag, stiffness (cubic, quadratic, hardening), contact (end
  stop, clearance, slack, backlash), hysteresis, memory (Maxwell, hidden mode, fluid memory, pulley inertia),
  load, motor dynamics (lag, second order, extra delay), motor limits (rate, saturation, quantisation), link,
  sensor, parameter.
- In a fifth of the cases the plant's parameters are uncertain, and off by about as much as the spec says;
  where nothing else is missing in such a case, `retuned` is no false alarm.
- Both of a pair, and all of a triple, are found when their families are named.
- A stated value is within two standard deviations of the true one; counted over all parameters of kinds that
  are named rightly.
- The true model's held-out error is that of the noise-free motion against the recording.
""".splitlines()
