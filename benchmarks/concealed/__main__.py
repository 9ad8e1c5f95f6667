"""Make the table: ``python -m benchmarks.concealed --out PATH``; run again, it goes on where it stopped."""

from __future__ import annotations

import argparse
import json
import secrets
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.concealed.case import make_case
from benchmarks.concealed.diagnose import DiagnosisError, diagnose
from benchmarks.concealed.kinds import family
from benchmarks.concealed.plan import Item, plan
from benchmarks.concealed.score import canonical, score
from benchmarks.concealed.table import by_kind, machine, markdown, summary

RTHM = f"{Path(sys.executable).parent / 'rthm'} diagnose {{bag}} --spec {{spec}} --json -"


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.concealed", description=__doc__)
    parser.add_argument(
        "--bags",
        type=int,
        default=185,
        help="cases with one effect; a multiple of 37 has every kind equally often",
    )
    parser.add_argument("--clean", type=int, default=100, help="cases in which nothing is missing")
    parser.add_argument("--pairs", type=int, default=30, help="cases with two effects")
    parser.add_argument("--retuned", type=int, default=30, help="cases with a wrong mass or damping")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        help="path without ending: .jsonl (cases), .json (numbers), .md (page) are written",
    )
    parser.add_argument("--workers", type=int, default=2, help="diagnoses at a time")
    parser.add_argument(
        "--lateness", type=float, default=0.0, help="mean extra delay of every link, s; 0: exact"
    )
    parser.add_argument("--duration", type=float, default=60.0, help="seconds of each recording")
    parser.add_argument("--command", default=RTHM, help="how to diagnose {bag} with {spec}; prints JSON")
    parser.add_argument(
        "--oracle",
        default="",
        help="the same when {block} and {kind} are told, for the held-out error; default: the true model's",
    )
    parser.add_argument("--limit", type=int, default=None, help="stop after so many cases")
    return parser.parse_args(words)


def started(options: argparse.Namespace) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return the header and the rows so far; a new file gets a master seed of its own."""
    path = options.out.with_suffix(".jsonl")
    counts = {k: getattr(options, k) for k in ("bags", "clean", "pairs", "retuned", "duration", "lateness")}
    if path.exists():
        header, *rows = (json.loads(line) for line in path.read_text().splitlines())
        if header["counts"] != counts:
            sys.exit(f"{path} was begun with {header['counts']}, not {counts}: use these or another --out.")
        return header, rows
    cases = options.bags + options.clean + options.pairs + options.retuned
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


def work(item: Item, options: argparse.Namespace) -> dict[str, Any]:
    """Make, diagnose and score one case; its truth is nowhere on disk while it is diagnosed."""
    with tempfile.TemporaryDirectory(prefix="case-") as folder:
        case = make_case(
            item.seed, item.kinds, item.size, Path(folder), item.retune, options.duration, options.lateness
        )
        row = (
            asdict(item)
            | {"concealed": item.kinds, "asked_size": item.size}
            | {k: case.truth[k] for k in ("visibility", "share", "size")}
        )
        row["effects"] = [case.truth["spec"][name] for name in case.truth["spec"].get("effects", [])]
        if row["effects"]:
            row["true_family"] = family(*canonical(row["effects"][0]))
        begin = time.perf_counter()
        try:
            said = diagnose(options.command, case)
            row["seconds"] = time.perf_counter() - begin
            told = None
            if options.oracle and len(item.kinds) == 1:
                told = diagnose(options.oracle, case, block=item.kinds[0][0], kind=item.kinds[0][1])
            row |= score(item, case, said, told) | {
                "said": {k: said.get(k) for k in ("located", "physics", "retuned")}
            }
        except (DiagnosisError, KeyError, TypeError) as error:
            row |= {"error": f"{error}", "seconds": time.perf_counter() - begin}
    return row


def tell(done: int, cases: int, row: dict[str, Any]) -> None:
    """Show one case on standard error."""
    hidden = " + ".join(f"{b} {k}" for b, k in row["concealed"]) or f"{row['group']} {row['retune']}"
    named = row.get("error") or " + ".join(f"{b} {k}" for b, k in row["found"]) or row["verdict"]
    print(
        f"[{done:4d}/{cases}] {hidden} ({row['size']:.2g}) -> {named} ({row['seconds']:.1f} s)",
        file=sys.stderr,
        flush=True,
    )


def finish(options: argparse.Namespace, header: dict[str, Any], rows: list[dict[str, Any]]) -> None:
    """Write the page and its numbers."""
    numbers = header | {"summary": summary(rows), "kinds": by_kind(rows)}
    options.out.with_suffix(".json").write_text(json.dumps(numbers, indent=1) + "\n")
    options.out.with_suffix(".md").write_text(markdown(header, rows))


def main(words: list[str] | None = None) -> int:
    """Make the table; `words` in place of the command line's."""
    options = arguments(words)
    header, rows = started(options)
    counts = header["counts"]
    items = plan(header["master"], *(counts[k] for k in ("bags", "clean", "pairs", "retuned")))
    left = [i for i in items if i.index not in {r["index"] for r in rows}][: options.limit]
    with ThreadPoolExecutor(options.workers) as pool, options.out.with_suffix(".jsonl").open("a") as file:
        jobs = [pool.submit(work, item, options) for item in left]
        for job in as_completed(jobs):
            rows.append(json.loads(json.dumps(job.result())))
            file.write(json.dumps(rows[-1]) + "\n")
            file.flush()
            tell(len(rows), header["cases"], rows[-1])
    finish(options, header, rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
