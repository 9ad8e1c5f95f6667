"""Measure and judge: ``python -m benchmarks.realtime --out PATH``."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.realtime.host import interruptions, taken
from benchmarks.realtime.judge import Line, judge_real_time, judge_simulated_time
from benchmarks.realtime.measure import in_real_time, in_simulated_time
from benchmarks.realtime.short_periods import judge_short_periods, with_short_periods
from benchmarks.realtime.table import machine, markdown

PARTS = {
    "real": ("In real time", in_real_time, judge_real_time),
    "periods": ("With all clocks at short periods", with_short_periods, judge_short_periods),
    "virtual": ("In simulated time", in_simulated_time, judge_simulated_time),
}
"""What is run: its heading, how it is measured and how it is judged."""


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.realtime", description=__doc__)
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        help="path without ending: .json (numbers) and .md (page) are written",
    )
    parser.add_argument("--duration", type=float, default=20.0, help="length of each run, s")
    parser.add_argument("--spec", default="paper", help="shipped spec")
    parser.add_argument("--only", choices=sorted(PARTS), action="append", help="default: all")
    return parser.parse_args(words)


def main(words: list[str] | None = None) -> int:
    """Run, judge and write; 1 when something asked for is not met."""
    options = arguments(words)
    header: dict[str, Any] = {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": machine(),
        "load": os.getloadavg()[0],
        "interruptions": [interruptions()],
        "spec": options.spec,
        "duration": options.duration,
    }
    figures: dict[str, Any] = {}
    lines: dict[str, list[Line]] = {}
    with tempfile.TemporaryDirectory(prefix="realtime-") as folder:
        for name in options.only or PARTS:
            heading, measure, judge = PARTS[name]
            print(heading, file=sys.stderr, flush=True)
            with taken() as told:
                figures[name] = measure(options.spec, options.duration, Path(folder))
            figures[name] |= told
            lines[heading] = judge(figures[name])
    header["interruptions"].append(interruptions())
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.with_suffix(".json").write_text(json.dumps(header | figures, indent=1) + "\n")
    header["taken"] = {PARTS[name][0]: figures[name]["taken"] for name in figures}
    page = markdown(header, lines)
    options.out.with_suffix(".md").write_text(page)
    print(page, end="")
    return 0 if all(line.met for rows in lines.values() for line in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
