"""Run, diagnose, run again as patched: ``python -m benchmarks.hidden --out PATH``."""

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

import numpy as np
from benchmarks.hidden.cases import HIDDEN, hidden

from rthm_analysis.recording import Recording, read_recording
from rthm_core.spec import Spec, shipped_spec, write_spec

RTHM = [sys.executable, "-m", "rthm_bringup"]
NOMINAL = "paper_noisy"


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


def run(spec: Spec, folder: Path, duration: float) -> tuple[Path, Recording]:
    """Bag of a run of the real node graph."""
    folder.mkdir(parents=True)
    (folder / "spec.yaml").write_text(write_spec(spec), encoding="utf-8")
    words = ("run", str(folder / "spec.yaml"), "--duration", str(duration), "--out", str(folder / "out"))
    bag = Path(rthm(*words)["bag"])
    return bag, read_recording(bag)


def difference(one: Recording, other: Recording) -> float:
    """Rms difference of x1 in two recordings, over the standard deviation of the first."""
    count = min(len(one.plant), len(other.plant))
    first, second = (r.plant.columns("position", ["x1"])[:count, 0] for r in (one, other))
    return float(np.sqrt(np.nanmean(np.square(first - second))) / np.nanstd(first))


def case(number: int, plain: Recording, folder: Path, duration: float) -> dict[str, Any]:
    """One effect: hidden, recorded, found, and put into the next run."""
    from rthm_core.spec import read_spec

    block, kind, parameters = HIDDEN[number]
    with_effect = hidden(shipped_spec(NOMINAL), block, kind, parameters)
    bag, recorded = run(with_effect, folder / "hidden", duration)
    patched = folder / "patched.yaml"
    said = rthm("diagnose", str(bag), "--spec", NOMINAL, "--patched", str(patched))
    _, again = run(read_spec(str(patched)), folder / "again", duration)
    _, repeated = run(with_effect, folder / "repeated", duration)
    return {
        "hidden": {"block": block, "kind": kind, **parameters},
        "verdict": said["verdict"],
        "found": [{k: one[k] for k in ("block", "kind", "parameters")} for one in said["physics"]],
        "right": [(one["block"], one["kind"]) for one in said["physics"]] == [(block, kind)],
        "nominal_run_differs": difference(recorded, plain),
        "patched_run_differs": difference(recorded, again),
        "repeated_run_differs": difference(recorded, repeated),
    }


def markdown(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    """Page of the results."""
    lines = [
        "# Effects hidden in a real node graph",
        "",
        f"{header['date']}, {header['machine']}; {NOMINAL}, {header['duration']:g} s each. "
        f"{sum(row['right'] for row in rows)} of {len(rows)} named exactly. The last three columns: rms "
        "difference of x1 between the recorded run and another real run, over its standard deviation; the "
        "last of them is what two runs of the very same spec differ by in real time on this machine.",
        "",
        "| hidden | verdict | found | run as specified differs by | run as patched differs by | repeated |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        differs = " | ".join(f"{row[f'{run}_run_differs']:.2g}" for run in ("nominal", "patched", "repeated"))
        found = ", ".join(f"{one['block']} {one['kind']}" for one in row["found"]) or "nothing"
        lines.append(
            f"| {row['hidden']['block']} {row['hidden']['kind']} | {row['verdict']} | {found} | {differs} |"
        )
    return "\n".join(lines) + "\n"


def main(words: list[str] | None = None) -> int:
    """Make the table; 1 when an effect was not named."""
    options = arguments(words)
    header = {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": f"{os.cpu_count()} cores ({platform.machine()}), Python {platform.python_version()}",
        "duration": options.duration,
    }
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory(prefix="hidden-") as folder:
        _, plain = run(shipped_spec(NOMINAL), Path(folder) / "plain", options.duration)
        for number in range(options.runs):
            rows.append(case(number, plain, Path(folder) / str(number), options.duration))
            print(rows[-1]["hidden"], "->", rows[-1]["found"], file=sys.stderr, flush=True)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.with_suffix(".json").write_text(json.dumps(header | {"runs": rows}, indent=1) + "\n")
    options.out.with_suffix(".md").write_text(markdown(header, rows))
    return 0 if all(row["right"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
