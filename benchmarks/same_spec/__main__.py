"""Diagnose simulations with their own spec: ``python -m benchmarks.same_spec --out PATH``."""

from __future__ import annotations

import argparse
import json
import shlex
import subprocess
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

from benchmarks.concealed.runner import Row, go_on, shared_arguments, started
from benchmarks.same_spec.draw import Draw, draws, spec_of
from benchmarks.same_spec.record import bag_of

from rthm_core.spec import write_spec

DRAWS = 200


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.same_spec", description=__doc__)
    shared_arguments(parser)
    parser.add_argument("--draws", type=int, default=DRAWS, help="how many specs are drawn")
    return parser.parse_args(words)


def diagnosed(draw: Draw, options: argparse.Namespace) -> Row:
    """What the diagnosis says of one draw."""
    with tempfile.TemporaryDirectory(prefix="same_spec-") as name:
        folder = Path(name)
        spec, path = spec_of(draw), folder / "spec.yaml"
        path.write_text(write_spec(spec), encoding="utf-8")
        bag, begin = bag_of(draw, spec, path), time.perf_counter()
        command = [word.format(bag=bag, spec=path) for word in shlex.split(options.command)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        seconds = time.perf_counter() - begin
        return draw.row() | {"seconds": seconds} | _said(done, str(path.read_text(encoding="utf-8")))


def _said(done: subprocess.CompletedProcess[str], spec: str) -> dict[str, Any]:
    if done.returncode not in (0, 1) or not done.stdout:
        return {"verdict": "", "error": done.stderr[-400:], "spec": spec}
    told = json.loads(done.stdout)
    named = [f"{one['block']} {one['kind']}" for one in [*told["physics"], *told.get("faults", [])]]
    said = {"verdict": told["verdict"], "named": named, "retuned": sorted(told["retuned"])}
    if told["verdict"] == "match":
        return said
    return said | {"spec": spec, "blocks": told["blocks"]}


def which(row: Row) -> str:
    """Words for what was drawn."""
    where = "loop" if row["in_loop"] else "alone"
    channels = "x, v" if row["velocity"] else "x"
    return f"{row['block']} {row['kind']} {row['size']:g}, {where}, {channels}, {row['td1'] * 1e3:g} ms"


def named(row: Row) -> str:
    """Kinds and faults that were named."""
    return ", ".join(row.get("named", []))


def words(row: Row) -> str:
    """One line about a draw that is done."""
    return f"{which(row)} -> {row['verdict'] or 'no answer'} {named(row)}"


PAGE = """# Simulations diagnosed with their own spec

{date}, {machine}, master seed {master}. Each is simulated with an effect of the plant or the wire in its
spec, gets the sensors' noise, and is diagnosed with that very spec: nothing is missing. In a loop the node
graph runs in simulated time; a plant alone is simulated by the engine.

**{matches} of {count} are a match; {explained} are called explained.**
Again: `python -m benchmarks.same_spec --out docs/same_spec`.

| not a match | seed | verdict | named |
|---|---|---|---|
{table}
"""


def markdown(header: Row, rows: list[Row]) -> str:
    """Page of the results."""
    verdicts = Counter(row["verdict"] for row in rows)
    table = (
        f"| {which(row)} | {row['seed']} | {row['verdict'] or row['error']} | {named(row)} |"
        for row in rows
        if row["verdict"] != "match"
    )
    counts = {"matches": verdicts["match"], "explained": verdicts["explained"], "count": len(rows)}
    return PAGE.format(**header, **counts, table="\n".join(table))


def main(given: list[str] | None = None) -> None:
    """Draw, record and diagnose; an interrupted table goes on where it stopped."""
    options = arguments(given)
    header, rows = started(options.out, {"draws": options.draws}, options.draws)
    go_on(options, rows, draws(options.draws, header["master"]), diagnosed, words)
    rows.sort(key=lambda row: row["index"])
    options.out.with_suffix(".json").write_text(json.dumps(header | {"rows": rows}, indent=1) + "\n")
    options.out.with_suffix(".md").write_text(markdown(header, rows))


if __name__ == "__main__":
    main()
