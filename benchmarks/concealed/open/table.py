"""The second part's scores as numbers, and these in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from statistics import median
from typing import Any

from benchmarks.concealed.open import description, score
from benchmarks.concealed.table import share, summed

Row = dict[str, Any]
WORDS = {
    "unlisted": "what no kind of the library is",
    "spoiled": "faults of recordings and specs",
    "parameters": "plain parameter errors",
    "listed": "one to three kinds of the library",
    "clean": "nothing is missing",
}


def numbers(header: Row, rows: list[Row]) -> dict[str, Any]:
    """Return all that the page shows."""
    return header | {
        "done": len(rows),
        "summary": summary(rows),
        "classes": {group: _of(rows, "group", group) for group in WORDS},
        "names": {name: _of(rows, "name", name) for name in sorted({r["name"] for r in rows})},
        "group_of": {r["name"]: r["group"] for r in rows},
        "bad": [_told(r) for r in sorted(rows, key=lambda r: r["index"]) if _bad(r)],
    }


def summary(rows: list[Row]) -> dict[str, Any]:
    """Return the headline numbers: counts as ``[those, of]``."""
    clean = [r for r in rows if r["group"] == "clean"]
    open_ends = [r for r in rows if "block" in r]
    return {
        "wrong": _count(rows, "wrong"),
        "crashes": _count(rows, "error"),
        "alarms": _count(clean, "alarm"),
        "invented": _count(rows, "invented"),
        "block": _count(open_ends, "block"),
        "values": summed(r["values"] for r in rows if "values" in r),
        "description": _description(rows),
        "cpu_median": median([r["cpu"] for r in rows if "cpu" in r] or [0.0]),
        "cpu_largest": max((r["cpu"] for r in rows if "cpu" in r), default=0.0),
        "seconds_median": median(r["seconds"] for r in rows) if rows else None,
        "seconds_largest": max((r["seconds"] for r in rows), default=None),
    }


def _count(rows: list[Row], key: str) -> list[int]:
    return [sum(bool(r.get(key)) for r in rows), len(rows)]


def _description(rows: list[Row]) -> dict[str, list[int]]:
    """Return what was right about the descriptions of forces that no kind states, as counts."""
    told = [r["description"] for r in rows if "description" in r]
    keys = ("variables", "interval", "formula", "twice", "near")
    return {key: [sum(d[key] for d in told if key in d), sum(key in d for d in told)] for key in keys}


def _of(rows: list[Row], key: str, value: str) -> dict[str, Any]:
    """Return counts of the rows whose `key` is `value`, and what the verdicts were."""
    some = [r for r in rows if r[key] == value]
    counts = {k: _count(some, k) for k in ("right", "wrong", "invented", "alarm", "error")}
    verdicts = dict(Counter(r.get("verdict", "no answer") for r in some))
    return counts | {"block": _count([r for r in some if "block" in r], "block"), "verdicts": verdicts}


def _bad(row: Row) -> bool:
    return any(row.get(k) for k in ("wrong", "invented", "alarm", "error"))


def _told(row: Row) -> dict[str, Any]:
    """Return a case that went wrong so that it can be made again."""
    what = next(k for k in ("error", "wrong", "alarm", "invented") if row.get(k))
    named = row.get("error") or ", ".join(words for _, words in row["false"]) or "nothing false"
    return {"name": row["name"], "seed": row["seed"], "rig": row["rig"], "what": what,
            "verdict": row.get("verdict", "none"), "named": named}  # fmt: skip


def markdown(n: dict[str, Any]) -> str:
    """Return the second part of the page, from its numbers."""
    lines = ["## Second part: an open world", "", _made(n), "", *_headline(n["summary"])]
    lines += _table(n["classes"], "class", lambda name: WORDS[name])
    lines += ["### Every name", ""]
    lines += _table(n["names"], "case", lambda name: f"{name} ({n['group_of'][name]})")
    lines += ["### What went wrong", ""]
    lines += [
        f"- {b['what']}: {b['name']} on {b['rig']}, seed {b['seed']}: {b['verdict']}; {b['named']}"
        for b in n["bad"]
    ] or ["Nothing."]
    return "\n".join([*lines, "", "### How it is scored", "", *_rules(), ""])


def _made(n: dict[str, Any]) -> str:
    return (
        f"Made {n['date']} on {n['machine']} by `python -m benchmarks.concealed.open`, master seed "
        f"{n['master']}, {n['done']} of {n['cases']} cases. Hybrid tests, and plants alone under a known "
        "force or in free decay, on rigs from micrometres and kilohertz to ships of 0.1 Hz. A case is made "
        "again by `make_open_case(seed, name, folder)`."
    )


def _headline(s: dict[str, Any]) -> list[str]:
    lines = [
        ("confident wrong answers", "wrong", "at most 2 %"),
        ("crashes and refusals", "crashes", "0"),
        ("false alarms where nothing is missing", "alarms", "at most 1"),
        ("names that are not true under `improved` or `unexplained`", "invented", "0"),
        ("right block under `improved` and `unexplained`", "block", "90 %"),
        ("values within two stated standard deviations", "values", "90 %"),
    ]
    out = ["| | counted | asked |", "|---|---|---|"]
    out += [f"| {words} | {share(s[key])} | {asked} |" for words, key, asked in lines]
    if s["seconds_median"] is not None:
        took = f"{s['seconds_median']:.1f} s, at most {s['seconds_largest']:.0f} s"
        out += ["", f"Median time of a diagnosis, start of the program included: {took}."]
    if s.get("cpu_largest"):
        out += ["", f"CPU time: median {s['cpu_median']:.1f} s, at most {s['cpu_largest']:.0f} s."]
    return [*out, "", *_descriptions(s.get("description") or {})]


def _descriptions(counts: dict[str, list[int]]) -> list[str]:
    """Return how forces were described that no kind of the library states."""
    lines = [
        ("variables", "variables right", "80 %"),
        ("interval", "interval right within 1 s, of those that have one", "80 %"),
        ("formula", "told as a formula", ""),
        ("twice", "held-out error of the model with it within twice the noise floor", "60 %"),
        ("near", "the same within 1.3 times", "40 %"),
    ]
    if not counts:
        return []
    out = ["### Forces that no kind states", "", "| | counted | asked |", "|---|---|---|"]
    out += [f"| {words} | {share(counts[key])} | {asked} |" for key, words, asked in lines]
    return [*out, ""]


def _table(groups: dict[str, Any], head: str, words: Callable[[str], str]) -> list[str]:
    out = [f"| {head} | right | wrong | invented | block | verdicts |", "|---|---|---|---|---|---|"]
    for name, g in groups.items():
        verdicts = ", ".join(f"{k} {n}" for k, n in sorted(g["verdicts"].items()))
        counts = " | ".join(share(g[k]) if k in ("right", "block") else str(g[k][0]) for k in COLUMNS)
        out.append(f"| {words(name)} | {counts} | {verdicts} |")
    return [*out, ""]


COLUMNS = ("right", "wrong", "invented", "block")


def _rules() -> list[str]:
    """Return how it is scored, from where it is scored."""
    told = [(module.__doc__ or "").split("\n", 1)[1] for module in (score, description)]
    return "\n\n".join(text.strip() for text in told).splitlines()
