"""Make the second part: ``python -m benchmarks.concealed.open --out PATH_open``; it goes on where it stopped.

With ``--case NAME SEED`` in place of ``--out``, one case is made in the folder NAME, and its truth is shown.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.concealed.diagnose import DiagnosisError, diagnose
from benchmarks.concealed.open.case import make_open_case
from benchmarks.concealed.open.description import description
from benchmarks.concealed.open.plan import OpenItem, open_plan
from benchmarks.concealed.open.score import open_score
from benchmarks.concealed.open.table import numbers
from benchmarks.concealed.page import write_page
from benchmarks.concealed.runner import go_on, shared_arguments, started

KEPT = ("located", "physics", "faults", "described", "retuned", "traces")
TRUTH = ("rig", "plain", "loaded", "velocity", "samples", "visibility")


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.concealed.open", description=__doc__)
    parser.add_argument("--cases", type=int, default=320, help="how many, a third of them clean")
    shared_arguments(parser)
    return parser.parse_args(words)


def work(item: OpenItem, options: argparse.Namespace) -> dict[str, Any]:
    """Make, diagnose and score one case; its truth is nowhere on disk while it is diagnosed."""
    with tempfile.TemporaryDirectory(prefix="case-") as folder:
        case = make_open_case(item.seed, item.name, Path(folder))
        row = asdict(item) | {k: case.truth[k] for k in TRUTH} | {"hidden": [h.what for h in case.hidden]}
        begin = time.perf_counter()
        try:
            said = diagnose(options.command, case)
            row |= {"seconds": time.perf_counter() - begin, "cpu": said["cpu"]}
            row |= open_score(case, said) | {"said": {k: said.get(k) for k in KEPT}}
            if (described := description(case, said)) is not None:
                row["description"] = described
        except (DiagnosisError, KeyError, TypeError) as error:
            row |= {"error": f"{error!r}"[:300], "seconds": time.perf_counter() - begin}
    return row


def tell(row: dict[str, Any]) -> str:
    """Return one case in words."""
    judged = [k for k in ("right", "wrong", "invented", "alarm") if row.get(k)]
    false = ", ".join(words for _, words in row.get("false", []))
    said = row.get("error") or f"{row['verdict']} {' '.join(judged)}{f' ({false})' if false else ''}"
    return f"{row['group']} {row['name']} on {row['rig']} -> {said}"


def show(name: str, seed: int) -> None:
    """Make one case in a folder of its name and print its truth."""
    case = make_open_case(seed, name, Path(name))
    hidden = [asdict(h) for h in (*case.hidden, *case.tolerated)]
    print(json.dumps(case.truth | {"hidden": hidden, "allowed": case.allowed}, indent=1, default=str))


def main(words: list[str] | None = None) -> int:
    """Make the table; `words` in place of the command line's."""
    words = sys.argv[1:] if words is None else words
    if len(words) == 3 and words[0] == "--case":
        show(words[1], int(words[2]))
        return 0
    options = arguments(words)
    header, rows = started(options.out, {"cases": options.cases}, options.cases)
    go_on(options, rows, open_plan(header["master"], options.cases), work, tell)
    options.out.with_suffix(".json").write_text(json.dumps(numbers(header, rows), indent=1) + "\n")
    write_page(options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
