"""Run, diagnose, run again as patched: ``python -m benchmarks.hidden --out PATH``.

On a machine that stands still now and then samples are late, and two runs of one spec differ. So each
recorded run is also repeated by the exact engine along the very delays that it had, by the spec that
diagnosis was given, by the one that it wrote, and by the one that really ran.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from benchmarks.hidden.cases import HIDDEN, hidden
from benchmarks.hidden.compare import Run, off_along_delays, off_each_other, read_run

from rthm_core.spec import Spec, read_spec, shipped_spec, write_spec

RTHM = [sys.executable, "-m", "rthm_bringup"]
NOMINAL = "paper_noisy"
COLUMNS = {
    "as_specified": "as specified",
    "as_patched": "as patched",
    "as_hidden": "as it ran",
    "run_again": "run again as patched",
    "repeated": "repeated",
}
"""Keys of the comparisons and heads of their columns."""


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hidden", description=__doc__)
    parser.add_argument(
        "--out", type=Path, required=True, help="path without ending: .json and .md are written"
    )
    parser.add_argument("--runs", type=int, default=len(HIDDEN), help="how many of the effects")
    parser.add_argument("--duration", type=float, default=20.0, help="length of each run, s")
    return parser.parse_args(words)


def rthm(*words: str) -> dict[str, Any]:
    """JSON that a verb prints."""
    done = subprocess.run([*RTHM, *words, "--json", "-"], capture_output=True, text=True, check=False)
    if not done.stdout.strip():
        raise RuntimeError(f"rthm {words[0]}: {done.stderr.strip()}")
    return dict(json.loads(done.stdout[done.stdout.index("{") :]))


def run(spec: Spec, folder: Path, options: argparse.Namespace) -> Run:
    """Run of the real node graph."""
    folder.mkdir(parents=True)
    (folder / "spec.yaml").write_text(write_spec(spec), encoding="utf-8")
    words = ("run", str(folder / "spec.yaml"), "--duration", str(options.duration))
    return read_run(Path(rthm(*words, "--out", str(folder / "run"))["bag"]))


def case(number: int, folder: Path, options: argparse.Namespace) -> dict[str, Any]:
    """One effect: hidden, recorded, found, and put into the next run."""
    block, kind, parameters = HIDDEN[number]
    nominal = shipped_spec(NOMINAL)
    with_effect = hidden(nominal, block, kind, parameters)
    recorded = run(with_effect, folder / "hidden", options)
    file = folder / "patched.yaml"
    said = rthm("diagnose", str(recorded.bag), "--spec", NOMINAL, "--patched", str(file))
    patched = read_spec(str(file))
    again, repeated = (
        run(spec, folder / name, options) for spec, name in ((patched, "again"), (with_effect, "repeated"))
    )
    signal = "F" if block == "sensor.force" else "x1"
    return {
        "hidden": {"block": block, "kind": kind, **parameters},
        "verdict": said["verdict"],
        "found": [{k: one[k] for k in ("block", "kind", "parameters")} for one in said["physics"]],
        "right": [(one["block"], one["kind"]) for one in said["physics"]] == [(block, kind)],
        "late": {"recorded": recorded.late, "run_again": again.late, "repeated": repeated.late},
        "signal": signal,
        "differs": {
            "as_specified": off_along_delays(recorded, nominal, signal),
            "as_patched": off_along_delays(recorded, patched, signal),
            "as_hidden": off_along_delays(recorded, with_effect, signal),
            "run_again": off_each_other(recorded, again, signal),
            "repeated": off_each_other(recorded, repeated, signal),
        },
    }


def markdown(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    """Page of the results."""
    heads = ["hidden", "verdict", "found", *COLUMNS.values(), "late"]
    lines = [
        "# Effects hidden in a real node graph",
        "",
        f"{header['date']}, {header['machine']}; {NOMINAL}, {header['duration']:g} s each in real time. "
        f"{sum(row['right'] for row in rows)} of {len(rows)} named exactly. Again: `python -m "
        "benchmarks.hidden --out docs/hidden`.",
        "",
        "Columns after what was found: rms difference of x1 (of F, where its sensor is off) from the "
        "recorded run, over its standard deviation, without the sensor's noise.",
        "",
        "- *as specified*, *as patched*, *as it ran*: the exact engine with the spec that the diagnosis was "
        "given, with the one that it wrote, and with the one that was hidden, along the delays that the "
        "recorded run really had (`rthm simulate --as-recorded`).",
        "- *run again as patched*, *repeated*: another real run with the patched spec, and with the very "
        "spec that was hidden. They have delays of their own; *late* is how many samples were used late "
        "in the recorded run and in these two, since the machine stood still.",
        "",
        f"| {' | '.join(heads)} |",
        f"|{'---|' * len(heads)}",
    ]
    for row in rows:
        found = ", ".join(f"{one['block']} {one['kind']}" for one in row["found"]) or "nothing"
        differs = [f"{row['differs'][key]:.2g}" for key in COLUMNS]
        late = ", ".join(str(count) for count in row["late"].values())
        cells = [f"{row['hidden']['block']} {row['hidden']['kind']}", row["verdict"], found, *differs, late]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def main(words: list[str] | None = None) -> int:
    """Make the table; 1 when an effect was not named."""
    options = arguments(words)
    header = {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": f"{os.cpu_count()} cores ({platform.machine()}), Python {platform.python_version()}",
        "duration": options.duration,
    }
    rows = list[dict[str, Any]]()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="hidden-") as folder:
        for number in range(options.runs):
            rows.append(case(number, Path(folder) / str(number), options))
            print(
                rows[-1]["hidden"], "->", rows[-1]["found"], rows[-1]["differs"], file=sys.stderr, flush=True
            )
            options.out.with_suffix(".json").write_text(json.dumps(header | {"runs": rows}, indent=1) + "\n")
            options.out.with_suffix(".md").write_text(markdown(header, rows))
    return 0 if all(row["right"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
