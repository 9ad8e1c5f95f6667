"""Make the first part: ``python -m benchmarks.concealed --out PATH``; it goes on where it stopped."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.concealed.case import make_case
from benchmarks.concealed.diagnose import DiagnosisError, diagnose
from benchmarks.concealed.kinds import family
from benchmarks.concealed.page import write_page
from benchmarks.concealed.plan import Item, plan
from benchmarks.concealed.runner import go_on, shared_arguments, started
from benchmarks.concealed.score import canonical, score
from benchmarks.concealed.table import numbers

GROUPS = ("bags", "clean", "pairs", "triples", "retuned")


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
    parser.add_argument("--triples", type=int, default=20, help="cases with three effects")
    parser.add_argument("--retuned", type=int, default=30, help="cases with a wrong mass or damping")
    shared_arguments(parser)
    parser.add_argument(
        "--lateness", type=float, default=0.0, help="mean extra delay of every link, s; 0: exact"
    )
    parser.add_argument("--duration", type=float, default=60.0, help="seconds of each recording")
    parser.add_argument(
        "--oracle",
        default="",
        help="the same when {block} and {kind} are told, for the held-out error; default: the true model's",
    )
    return parser.parse_args(words)


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


def tell(row: dict[str, Any]) -> str:
    """Return one case in words."""
    hidden = " + ".join(f"{b} {k}" for b, k in row["concealed"]) or f"{row['group']} {row['retune']}"
    named = row.get("error") or " + ".join(f"{b} {k}" for b, k in row["found"]) or row["verdict"]
    return f"{hidden} ({row['size']:.2g}) -> {named}"


def main(words: list[str] | None = None) -> int:
    """Make the table; `words` in place of the command line's."""
    options = arguments(words)
    counts = {k: getattr(options, k) for k in (*GROUPS, "duration", "lateness")}
    header, rows = started(options.out, counts, sum(counts[k] for k in GROUPS))
    go_on(options, rows, plan(header["master"], *(counts[k] for k in GROUPS)), work, tell)
    options.out.with_suffix(".json").write_text(json.dumps(numbers(header, rows), indent=1) + "\n")
    write_page(options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
