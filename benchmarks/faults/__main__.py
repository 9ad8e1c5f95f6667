"""Make the table: ``python -m benchmarks.faults --out docs/faults``; it goes on where it stopped."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from dataclasses import asdict, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.faults.attempt import attempt, own_domain
from benchmarks.faults.catalogue import FAULTS, Fault
from benchmarks.faults.judge import Outcome
from benchmarks.faults.laboratory import PATIENT, STRICT, Laboratory
from benchmarks.faults.page import markdown
from benchmarks.hosts import NoHostsError, hosts
from benchmarks.realtime.table import machine

ATTEMPTS = 3
"""How often a test is tried that a busy machine disturbs."""


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument(
        "--out", type=Path, required=True, help="path without ending: .jsonl, .json and .md are written"
    )
    parser.add_argument("--only", metavar="NAME,...", default="", help="these faults, made again")
    parser.add_argument(
        "--patient", action="store_true", help="limits for a busy machine: stale 0.5 s, heartbeat 0.8 s"
    )
    return parser.parse_args(words)


def made(fault: Fault, limits: dict[str, Any]) -> tuple[Outcome, int] | None:
    """Make one fault, again where a busy machine disturbed it, and count; None: not possible here."""
    count, again = 0, True
    while again:
        count += 1
        with tempfile.TemporaryDirectory(prefix="fault-") as place, own_domain(Path(place)) as environment:
            if fault.way.hosts:
                try:
                    with hosts() as names:
                        laboratory = Laboratory(environment, Path(place), names[0], limits)
                        outcome = attempt(fault, laboratory, names)
                except NoHostsError as error:
                    print(f"{fault.name}: {error}", file=sys.stderr)
                    return None
            else:
                outcome = attempt(fault, Laboratory(environment, Path(place), limits=limits))
        outcome = replace(outcome, words=outcome.words.replace(f"{place}/", ""))
        again = outcome.disturbed and bool(outcome.complaints) and count < ATTEMPTS
    return outcome, count


def started(path: Path, limits: dict[str, Any]) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
    """Return the header and the outcomes so far, by the name of the fault."""
    if path.exists():
        header, *rows = (json.loads(line) for line in path.read_text().splitlines())
        if header["limits"] == json.loads(json.dumps(limits)):
            return header, {row["name"]: row for row in rows}
        sys.exit(f"{path} was begun with {header['limits']}: use these or another --out.")
    header = {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": machine(),
        "load": [],
        "limits": limits,
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(header) + "\n")
    return header, {}


def main(words: list[str] | None = None) -> int:
    """Make the table; 1 when something is not as it must be."""
    options = arguments(words)
    limits = PATIENT if options.patient else STRICT
    path = options.out.with_suffix(".jsonl")
    header, rows = started(path, limits)
    asked = set(filter(None, options.only.split(",")))
    for fault in FAULTS:
        if fault.name not in (asked or {one.name for one in FAULTS} - rows.keys()):
            continue
        begin, load = time.monotonic(), os.getloadavg()[0]
        found = made(fault, limits)
        if found is None:
            continue
        outcome, count = found
        row = asdict(outcome) | {"load": load, "attempts": count, "seconds": time.monotonic() - begin}
        rows[fault.name] = json.loads(json.dumps(row))
        with path.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(_said(row, len(rows)), file=sys.stderr, flush=True)
    return finish(options.out, header, rows)


def finish(out: Path, header: dict[str, Any], rows: dict[str, dict[str, Any]]) -> int:
    """Write the numbers and the page."""
    listed = [rows[fault.name] for fault in FAULTS if fault.name in rows]
    out.with_suffix(".json").write_text(json.dumps(header | {"faults": listed}, indent=1) + "\n")
    loads = [row["load"] for row in listed] or [0.0]
    head = header | header["limits"] | {"load": f"{min(loads):.1f} to {max(loads):.1f}"}
    out.with_suffix(".md").write_text(markdown(head, listed))
    return 1 if any(row["complaints"] for row in listed) else 0


def _said(row: dict[str, Any], count: int) -> str:
    verdict = "; ".join(row["complaints"]) or "as demanded"
    said = f"[{count}/{len(FAULTS)}] {row['name']}: status {row['status']}, {row['limit']}: {row['words']}"
    return f"{said} -> {verdict} ({row['seconds']:.0f} s)"


if __name__ == "__main__":
    sys.exit(main())
