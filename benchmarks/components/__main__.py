"""Dampers on a test bench, concealed: ``python -m benchmarks.components --out docs/components``.

A damper is right where its force is told to depend on what it does depend on, and its error on the unseen
third is within 1.5 times the noise of the force.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.components.damper import draw, write_csv
from benchmarks.concealed.runner import go_on, shared_arguments, started

RTHM = str(Path(sys.executable).parent / "rthm")
MAPS = ("position:x1=stroke", "force:a1=load cell", "input:voltage=voltage")
NEAR_FLOOR = 1.5

HEAD = """# Dampers on a test bench

Made {date} on {machine} by `python -m benchmarks.components`, master seed {master}.
Bouc-Wen hysteresis and viscous damping beside a spring; in four of five dampers a voltage gates the first two
behind a lag, in the others it does nothing. Equations and file are the benchmark's own; `rthm import` and
`rthm component` see the file of the data logger.
Error: on the unseen third; floor: noise of the force's sensor.

| rate (Hz) | depends on | told | verdict | error over the floor | lag (ms) | told (ms) | seconds |
|---|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Item:
    """A damper to draw."""

    index: int
    seed: int


def work(item: Item, options: argparse.Namespace) -> dict[str, Any]:
    """Draw, identify and score one damper."""
    damper = draw(item.seed)
    with tempfile.TemporaryDirectory(prefix="damper-") as folder:
        path = Path(folder) / "damper.csv"
        write_csv(damper, path)
        maps = [word for one in MAPS for word in ("--map", one)]
        subprocess.run(
            [RTHM, "import", path, "-o", Path(folder) / "bag", *maps], check=True, capture_output=True
        )
        begin = time.perf_counter()
        words = options.command.format(bag=Path(folder) / "bag").split()
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        seconds = time.perf_counter() - begin
    row = {"index": item.index, "seed": item.seed, "inputs": list(damper.inputs), "truth": damper.truth}
    row |= {"noise": damper.noise, "share": damper.share, "seconds": seconds}
    try:
        said = json.loads(done.stdout)
    except ValueError:
        return row | {"error": done.stderr[-500:], "told": [], "ratio": float("nan")}
    lag = said["lags"].get("voltage", {}).get("value", 0.0)
    kinds = [term["kind"] for term in said["terms"]]
    row |= {"verdict": said["verdict"], "told": said["depends_on"], "kinds": kinds, "lag": lag}
    return row | {
        "ratio": said["errors"]["found"] / damper.noise,
        "plain": said["errors"]["plain"] / damper.noise,
    }


def is_right(row: dict[str, Any]) -> bool:
    """Whether the inputs are right and the error is near the floor."""
    return bool(row["told"] == row["inputs"] and row["ratio"] <= NEAR_FLOOR)


def page(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    """The table."""
    lines = []
    for row in rows:
        truth = row["truth"]
        true_lag = f"{1e3 * truth['lag']:.1f}" if truth["gated"] else "-"
        cells = [
            f"{truth['rate']:.0f}",
            ", ".join(row["inputs"]),
            ", ".join(row["told"]),
            row.get("verdict", "no answer"),
        ]
        cells += [
            f"{row['ratio']:.2f}",
            true_lag,
            f"{1e3 * row.get('lag', 0.0):.1f}",
            f"{row['seconds']:.0f}",
        ]
        lines.append(f"| {' | '.join(cells)} |")
    right = sum(map(is_right, rows))
    lines += [
        "",
        f"Right inputs, and at most {NEAR_FLOOR} times the floor: {right}/{len(rows)} (asked 8 of 10).",
    ]
    return HEAD.format(**header) + "\n".join(lines) + "\n"


def main(words: list[str] | None = None) -> None:
    """Make what is missing, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.components", description=__doc__)
    parser.add_argument("--draws", type=int, default=20, help="dampers to draw")
    shared_arguments(parser)
    parser.set_defaults(command=f"{RTHM} component {{bag}} --json -")
    options = parser.parse_args(words)
    header, rows = started(options.out, {"draws": options.draws}, options.draws)
    seeds = np.random.default_rng(header["master"]).integers(2**62, size=options.draws).tolist()
    go_on(options, rows, [Item(i, seed) for i, seed in enumerate(seeds)], work, _said)
    rows.sort(key=lambda row: int(row["index"]))
    options.out.with_suffix(".json").write_text(json.dumps({**header, "rows": rows}, indent=1) + "\n")
    options.out.with_suffix(".md").write_text(page(header, rows), encoding="utf-8")


def _said(row: dict[str, Any]) -> str:
    told = ", ".join(row["told"]) or row.get("verdict", "no answer")
    return f"{', '.join(row['inputs'])} -> {told}, {row['ratio']:.2f}"


if __name__ == "__main__":
    main()
