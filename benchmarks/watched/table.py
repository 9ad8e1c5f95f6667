"""The page about runs with a dashboard and without."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

from benchmarks.realtime.measure import Figures

TITLE = "# What a dashboard costs the test that it shows"
NOISE = 5e-5
"""Difference of two ages, s, that wakening a thread makes from run to run."""
COUNTS = ("missed", "lost")
"""What is counted in a run."""


def page(table: dict[str, Any]) -> str:
    """Text of the page; a link on which a dashboard cost something is marked in bold."""
    watched, alone = ([one for one in table["runs"] if one["watched"] is which] for which in (True, False))
    links = tuple(alone[0]["excess"])
    cost = sorted(one["cost"] for one in watched)
    verdict = ["yes" if _within(watched, alone, link) else "**no**" for link in links]
    counts = [_typical(watched, key) <= _count(alone, key) for key in COUNTS]
    compared = [tuple([one["excess"][link] for one in some] for some in (watched, alone)) for link in links]
    compared += [tuple([one[key] for one in some] for some in (watched, alone)) for key in COUNTS]
    rows = [
        ("", *links, "missed ticks", "lost samples"),
        ("---",) * (len(links) + 3),
        ("without", *(_span(alone, link) for link in links), *_counts(alone)),
        ("with", *(_span(watched, link) for link in links), *_counts(watched)),
        ("median within those without", *verdict, *("yes" if good else "**no**" for good in counts)),
        ("chance, if it cost nothing", *(_chance(*both) for both in compared)),
    ]
    made = (
        f"Made {table['date']} by `python -m benchmarks.watched`: {len(alone)} runs of `{table['spec']}` for "
        f"{table['duration']:g} s with a dashboard and its page's data taken, and {len(watched)} without, in "
        f"turn, on {table['machine']}."
    )
    told = (
        "Excess is the age of a sample at its use beyond that of the exact schedule, the 99th percentile of "
        "each run, smallest to largest of the runs; the counts are the largest of a run. Then: whether the "
        f"median with a dashboard is at most the largest without, ages within {1e6 * NOISE:.0f} us; and how "
        "likely runs with a dashboard would be so much later, or miss so much more, by their ranks, if it "
        "cost nothing (Mann-Whitney, one-sided)."
    )
    took = (
        f"The dashboard took {100 * cost[0]:.0f} to {100 * cost[-1]:.0f} % of a core while a test ran, at "
        "the lowest priority."
    )
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n\n".join([TITLE, made, told, "\n".join(lines), took]) + "\n"


def _within(watched: Sequence[Figures], alone: Sequence[Figures], link: str) -> bool:
    largest = max(one["excess"][link] for one in alone)
    return statistics.median(one["excess"][link] for one in watched) <= largest + NOISE


def _chance(watched: Sequence[float], alone: Sequence[float]) -> str:
    from scipy.stats import mannwhitneyu

    return f"{float(mannwhitneyu(watched, alone, alternative='greater').pvalue):.2f}"


def _span(runs: Sequence[Figures], link: str) -> str:
    found = sorted(1e6 * one["excess"][link] for one in runs)
    return f"{found[0]:.0f} to {found[-1]:.0f} us"


def _typical(runs: Sequence[Figures], key: str) -> float:
    return statistics.median(one[key] for one in runs)


def _count(runs: Sequence[Figures], key: str) -> int:
    return max(int(one[key]) for one in runs)


def _counts(runs: Sequence[Figures]) -> tuple[str, str]:
    told = []
    for key in COUNTS:
        some = sum(one[key] > 0 for one in runs)
        told.append(f"{_count(runs, key)}; none in {len(runs) - some} of {len(runs)}")
    return told[0], told[1]
