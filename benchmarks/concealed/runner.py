"""Make the cases of a table one after the other, and go on where it stopped."""

from __future__ import annotations

import argparse
import json
import secrets
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol

from benchmarks.concealed.table import machine

RTHM = f"{Path(sys.executable).parent / 'rthm'} diagnose {{bag}} --spec {{spec}} --json -"
Row = dict[str, Any]


class Numbered(Protocol):
    """An item of a plan."""

    index: int


def shared_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what both parts are asked for."""
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        help="path without ending: .jsonl (cases), .json (numbers) and the page of both parts are written",
    )
    parser.add_argument("--workers", type=int, default=2, help="diagnoses at a time")
    parser.add_argument("--command", default=RTHM, help="how to diagnose {bag} with {spec}; prints JSON")
    parser.add_argument("--limit", type=int, default=None, help="stop after so many cases")


def started(out: Path, counts: dict[str, Any], cases: int) -> tuple[Row, list[Row]]:
    """Return the header and the rows so far; a new file gets a master seed of its own."""
    path = out.with_suffix(".jsonl")
    if path.exists():
        header, *rows = (json.loads(line) for line in path.read_text().splitlines())
        if header["counts"] != counts:
            sys.exit(f"{path} was begun with {header['counts']}, not {counts}: use these or another --out.")
        return header, rows
    header = {
        "master": secrets.randbits(62),
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": machine(),
        "cases": cases,
        "counts": counts,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(header) + "\n")
    return header, []


def go_on(
    options: argparse.Namespace,
    rows: list[Row],
    items: Sequence[Numbered],
    work: Callable[[Any, argparse.Namespace], Row],
    words: Callable[[Row], str],
) -> None:
    """Add the rows that are missing, each written as soon as it is there."""
    done = {r["index"] for r in rows}
    left = [i for i in items if i.index not in done][: options.limit]
    with ThreadPoolExecutor(options.workers) as pool, options.out.with_suffix(".jsonl").open("a") as file:
        jobs = [pool.submit(work, item, options) for item in left]
        for job in as_completed(jobs):
            rows.append(json.loads(json.dumps(job.result())))
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
            said = f"[{len(rows):4d}/{len(items)}] {words(rows[-1])} ({rows[-1]['seconds']:.1f} s)"
            print(said, file=sys.stderr, flush=True)
