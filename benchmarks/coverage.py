"""Measure which lines the tests reach: ``python -m benchmarks.coverage --out docs/coverage``."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.concealed.table import machine

ROOT = Path(__file__).parents[1]
HEAD = """# What the tests reach

Made {date} ({machine}) by `python -m benchmarks.coverage --out docs/coverage`:
lines of each package that run while the tests do, those of started processes included. Of compiled functions
the lines that were compiled count.

{passed}

| package | lines | reached |
|---|---|---|
"""
LEAST = """
Files of which the tests reach least:

| file | lines | reached |
|---|---|---|
"""
FEWEST_LINES, LISTED = 20, 15
"""Lines of a file from which it is listed, and how many files are."""


def measured(scratch: Path, tests: list[str]) -> tuple[dict[str, Any], str]:
    """Run tests; return what coverage.py says of every file, and the closing line of pytest."""
    kept = {
        "COVERAGE_FILE": str(scratch / "lines"),
        "NUMBA_JIT_COVERAGE": "1",
        "RTHM_CACHE_DIR": str(scratch / "kernels"),  # what is loaded from a cache is not compiled
    }
    where: dict[str, Any] = {"cwd": ROOT, "env": os.environ | kept}
    coverage = [sys.executable, "-m", "coverage"]
    ran = subprocess.run(
        [*coverage, "run", "-m", "pytest", *tests], stdout=subprocess.PIPE, text=True, **where
    )
    subprocess.run([*coverage, "combine", "--quiet"], check=True, **where)
    subprocess.run([*coverage, "json", "--quiet", "-o", scratch / "lines.json"], check=True, **where)
    last = ran.stdout.strip().splitlines()[-1].strip("= ")
    return json.loads((scratch / "lines.json").read_text())["files"], last


def lines_of(files: dict[str, Any]) -> dict[str, tuple[int, int]]:
    """Lines of every file, and how many of them ran."""
    return {
        name: (one["summary"]["num_statements"], one["summary"]["covered_lines"])
        for name, one in files.items()
    }


def by_package(lines: dict[str, tuple[int, int]]) -> dict[str, tuple[int, int]]:
    """The same of every package."""
    totals: dict[str, list[int]] = defaultdict(lambda: [0, 0])
    for name, numbers in lines.items():
        package = totals[Path(name).parts[1]]
        package[:] = [a + b for a, b in zip(package, numbers, strict=True)]
    return {name: (total, ran) for name, (total, ran) in sorted(totals.items())}


def rows(lines: dict[str, tuple[int, int]]) -> str:
    """Rows of a table."""
    return "".join(
        f"| {name} | {total} | {100.0 * ran / total:.0f} % |\n" for name, (total, ran) in lines.items()
    )


def main() -> int:
    """Measure, and write the page and its numbers."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="path of the page, without its ending")
    parser.add_argument(
        "tests", nargs="*", default=["-m", "not long", "-q", "test", "src"], help="for pytest"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="coverage-") as scratch:
        files, passed = measured(Path(scratch), options.tests)
    lines = {name: one for name, one in lines_of(files).items() if one[0] > 0}
    packages = by_package(lines)
    large = {name: one for name, one in lines.items() if one[0] >= FEWEST_LINES}
    least = dict(sorted(large.items(), key=lambda item: item[1][1] / item[1][0])[:LISTED])
    date = f"{datetime.now(UTC):%Y-%m-%d}"
    head = HEAD.format(date=date, machine=machine(), passed=f"Tests: {passed}.")
    options.out.with_suffix(".md").write_text(head + rows(packages) + LEAST + rows(least))
    kept = {"date": date, "machine": machine(), "tests": passed, "packages": packages}
    options.out.with_suffix(".json").write_text(json.dumps(kept, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
