"""Effects of plants with two dofs, concealed: ``python -m benchmarks.two_dofs --out docs/two_dofs``.

At one of the dofs or between them, of a plant alone and of one on two motors; and nothing, in a few.
Equations, integration and bags are the benchmark's own. An effect is found where exactly its kind is named,
at its place.
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
from benchmarks.concealed.runner import go_on, shared_arguments, started
from benchmarks.two_dofs.case import make_case
from benchmarks.two_dofs.rig import PLACES

HEAD = """# Effects of plants with two dofs

Made {date} on {machine} by `python -m benchmarks.two_dofs`, master seed {master}.
The benchmark has equations, integration and bags of its own; a diagnosis sees the bag and the nominal spec.
Found: exactly the true kind is named, at its place.

| rig | place | found | right place, another kind | nothing named |
|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Item:
    """A case to make."""

    index: int
    seed: int
    place: str
    motors: bool


def plan(master: int, each: int, clean: int) -> list[Item]:
    """As many cases at every place of both rigs, and with nothing missing."""
    rng = np.random.default_rng(master)
    wanted = [(place, motors) for place in PLACES for motors in (False, True) for _ in range(each)]
    wanted += [("", motors) for motors in (False, True) for _ in range(clean)]
    order = rng.permutation(len(wanted))
    seeds = rng.integers(2**62, size=len(wanted))
    return [Item(i, int(seeds[i]), *wanted[k]) for i, k in enumerate(order)]


def work(item: Item, options: argparse.Namespace) -> dict[str, Any]:
    """Make, diagnose and score one case."""
    with tempfile.TemporaryDirectory(prefix="case-") as folder:
        case = make_case(item.seed, item.place, motors=item.motors, folder=Path(folder))
        begin = time.perf_counter()
        words = options.command.format(bag=case.bag, spec=case.spec).split()
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        seconds = time.perf_counter() - begin
    truth = {"kind": case.kind, "visibility": case.visibility, "parameters": case.parameters}
    row = {"index": item.index, "seed": item.seed, "place": item.place, "motors": item.motors}
    row |= truth | {"seconds": seconds}
    try:
        said = json.loads(done.stdout)
    except ValueError:
        return row | {"error": done.stderr[-500:], "named": []}
    named = [[one["kind"], _place(one)] for one in said["physics"]]
    return row | {"verdict": said["verdict"], "named": named, "words": said["words"][:400]}


def _place(one: dict[str, Any]) -> str:
    return "between" if one.get("relative_to") else str(one.get("dof") or one.get("actuator") or one["block"])


def is_found(row: dict[str, Any]) -> bool:
    """Whether exactly the true kind is named at its place; in a clean case, whether nothing is."""
    return row["named"] == ([[row["kind"], row["place"]]] if row["place"] else [])


def page(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    """The table."""
    lines = []
    for motors, rig in ((False, "plant alone"), (True, "two motors")):
        for place in (*PLACES, ""):
            some = [row for row in rows if (row["motors"], row["place"]) == (motors, place)]
            near = [r for r in some if not is_found(r) and any(at == place for _, at in r["named"])]
            silent = [r for r in some if not is_found(r) and not r["named"]]
            counts = [sum(map(is_found, some)), len(near), len(silent)]
            cells = [rig, place or "nothing missing", f"{counts[0]}/{len(some)}", *map(str, counts[1:])]
            lines.append(f"| {' | '.join(cells)} |")
    hidden = [row for row in rows if row["place"]]
    found, errors = sum(map(is_found, hidden)), sum("error" in row for row in rows)
    share = 100.0 * found / max(len(hidden), 1)
    told = f"{found}/{len(hidden)} ({share:.0f} %, asked 85 %); no answer: {errors}"
    lines += ["", f"Found with kind and place: {told}."]
    return HEAD.format(**header) + "\n".join(lines) + "\n"


def main(words: list[str] | None = None) -> None:
    """Make what is missing, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.two_dofs", description=__doc__)
    parser.add_argument("--each", type=int, default=8, help="cases at every place of both rigs")
    parser.add_argument("--clean", type=int, default=6, help="cases of both rigs in which nothing is missing")
    shared_arguments(parser)
    options = parser.parse_args(words)
    counts = {"each": options.each, "clean": options.clean}
    header, rows = started(options.out, counts, 2 * (3 * options.each + options.clean))
    go_on(options, rows, plan(header["master"], options.each, options.clean), work, _said)
    rows.sort(key=lambda row: int(row["index"]))
    options.out.with_suffix(".json").write_text(json.dumps({**header, "rows": rows}, indent=1) + "\n")
    options.out.with_suffix(".md").write_text(page(header, rows), encoding="utf-8")


def _said(row: dict[str, Any]) -> str:
    what = f"{row['kind']} at {row['place']}" if row["place"] else "nothing"
    named = ", ".join(f"{kind} at {place}" for kind, place in row["named"]) or row.get("verdict", "no answer")
    return f"{what} ({'two motors' if row['motors'] else 'alone'}) -> {named}"


if __name__ == "__main__":
    sys.exit(main())
