"""Measure runs with a dashboard and without in turn and write what both had."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from datetime import date
from pathlib import Path

from benchmarks.realtime.measure import Figures, run
from benchmarks.realtime.table import machine
from benchmarks.watched.table import page
from benchmarks.watched.watching import dashboard


def main() -> None:
    """Run the benchmark; the status is 1 when a test beside a dashboard left the spread of those without."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.watched", description=__doc__)
    parser.add_argument("--runs", type=int, default=5, help="runs of each")
    parser.add_argument("--duration", type=float, default=10.0, help="length of a run, s")
    parser.add_argument("--spec", default="paper", help="shipped test")
    parser.add_argument("--domain", type=int, default=87, help="ROS domain of all runs")
    parser.add_argument("--out", type=Path, help="path without ending, for the page and the numbers")
    asked = parser.parse_args()
    made = measured(asked.runs, asked.spec, asked.duration, asked.domain)
    header = {"date": date.today().isoformat(), "machine": machine(), "spec": asked.spec}
    table = {**header, "duration": asked.duration, "runs": made}
    text = page(table)
    print(text)
    if asked.out:
        asked.out.with_suffix(".json").write_text(json.dumps(table, indent=1) + "\n")
        asked.out.with_suffix(".md").write_text(text)
    sys.exit("**no**" in text)


def measured(runs: int, spec: str, duration: float, domain: int) -> list[Figures]:
    """Figures of all runs, in the order in which they ran."""
    made: list[Figures] = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(2 * runs):
            watched, out = bool(number % 2), Path(folder) / str(number)
            options = ("--domain", str(domain))
            if watched:
                with dashboard(domain) as cost:
                    told = run(spec, duration, out, *options)
                made.append(figures(told) | {"watched": True, "cost": cost()})
            else:
                made.append(figures(run(spec, duration, out, *options)) | {"watched": False})
            print(f"{number + 1} of {2 * runs}", file=sys.stderr, flush=True)
    return made


def figures(told: Figures) -> Figures:
    """What counts of a run: excess of every link (99th percentile, s), missed ticks, samples lost."""
    links = told["links"]
    return {
        "excess": {name: link["excess"]["p99"] for name, link in links.items()},
        "missed": told["missed_deadlines"],
        "lost": told["lost"] + sum(link["lost"] for link in links.values()),
    }


if __name__ == "__main__":
    main()
