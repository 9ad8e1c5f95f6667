"""Run, diagnose, run again as patched: ``python -m benchmarks.hidden --out PATH``.

A machine that stands still makes samples late, after which two runs of one spec differ. Runs are compared
as long as every sample of theirs was used at the instant of the exact schedule. A run in which that was not
so to its end is made again, some times, and the one that went longest is kept; made again, the table keeps
its rows in which all runs went to their end.
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
from typing import Any, NamedTuple

import numpy as np
from benchmarks.hidden.cases import HIDDEN, hidden

from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.timing import timing_of
from rthm_core.clock import NS
from rthm_core.spec import Spec, shipped_spec, write_spec

RTHM = [sys.executable, "-m", "rthm_bringup"]
NOMINAL = "paper_noisy"
HAIR = 1e-9
"""Seconds by which an exact use may be off."""
ALMOST = 0.99
"""Part of a run to which it must be exact to be a whole one: links go on when the plant has stopped."""


class Run(NamedTuple):
    """A run of the node graph: its bag, the recording in it, and the seconds to the first late sample."""

    bag: Path
    recording: Recording
    exact: float


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hidden", description=__doc__)
    parser.add_argument(
        "--out", type=Path, required=True, help="path without ending: .json and .md are written"
    )
    parser.add_argument("--runs", type=int, default=len(HIDDEN), help="how many of the effects")
    parser.add_argument("--duration", type=float, default=20.0, help="length of each run, s")
    parser.add_argument(
        "--attempts", type=int, default=4, help="how often a run is made at most until no sample was late"
    )
    return parser.parse_args(words)


def rthm(*words: str) -> dict[str, Any]:
    """JSON that a verb prints."""
    done = subprocess.run([*RTHM, *words, "--json", "-"], capture_output=True, text=True, check=False)
    if not done.stdout.strip():
        raise RuntimeError(f"rthm {words[0]}: {done.stderr.strip()}")
    return dict(json.loads(done.stdout[done.stdout.index("{") :]))


def exact_until(recording: Recording) -> float:
    """Seconds until a link delivered another sample than the exact schedule has, or at another instant.

    Receivers with a clock use a sample at their tick, however late they wake; the motor as it comes.
    """
    spec = recording.spec
    assert spec is not None and spec.timing is not None
    until = float(recording.plant.stamp_ns[-1] - recording.start_ns) / NS
    for name, link in timing_of(recording, spec).links.items():
        off = np.abs(link.excess) > (HAIR if name == "tau4" else 0.5 * spec.timing.td1)
        until = min(until, float(link.use[off].min(initial=np.inf)))
    return until


def run(spec: Spec, folder: Path, options: argparse.Namespace) -> Run:
    """Run of the real node graph that the machine left alone longest."""
    folder.mkdir(parents=True)
    (folder / "spec.yaml").write_text(write_spec(spec), encoding="utf-8")
    runs: list[Run] = []
    for attempt in range(options.attempts):
        words = ("run", str(folder / "spec.yaml"), "--duration", str(options.duration))
        bag = Path(rthm(*words, "--out", str(folder / str(attempt)))["bag"])
        recording = read_recording(bag)
        runs.append(Run(bag, recording, exact_until(recording)))
        if runs[-1].exact > ALMOST * options.duration:
            break
    return max(runs, key=lambda one: one.exact)


def compared(one: Run, other: Run) -> dict[str, float]:
    """Rms difference of x1 in two runs over its standard deviation, as long as both are exact."""
    plant, until = one.recording.plant, min(one.exact, other.exact)
    count = int(np.searchsorted(plant.stamp_ns, one.recording.start_ns + int(until * NS)))
    first, second = (run.recording.plant.columns("position", ["x1"])[:count, 0] for run in (one, other))
    differs = float(np.sqrt(np.nanmean(np.square(first - second))) / np.nanstd(first))
    return {"differs": differs, "until": until}


def case(number: int, plain: Run, folder: Path, options: argparse.Namespace) -> dict[str, Any]:
    """One effect: hidden, recorded, found, and put into the next run."""
    from rthm_core.spec import read_spec

    block, kind, parameters = HIDDEN[number]
    with_effect = hidden(shipped_spec(NOMINAL), block, kind, parameters)
    recorded = run(with_effect, folder / "hidden", options)
    patched = folder / "patched.yaml"
    said = rthm("diagnose", str(recorded.bag), "--spec", NOMINAL, "--patched", str(patched))
    again = run(read_spec(str(patched)), folder / "again", options)
    repeated = run(with_effect, folder / "repeated", options)
    others = {"nominal": plain, "patched": again, "repeated": repeated}
    return {
        "hidden": {"block": block, "kind": kind, **parameters},
        "verdict": said["verdict"],
        "found": [{k: one[k] for k in ("block", "kind", "parameters")} for one in said["physics"]],
        "right": [(one["block"], one["kind"]) for one in said["physics"]] == [(block, kind)],
        "runs": {name: compared(recorded, one) for name, one in others.items()},
    }


def markdown(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    """Page of the results."""
    lines = [
        "# Effects hidden in a real node graph",
        "",
        f"{header['date']}, {header['machine']}; {NOMINAL}, {header['duration']:g} s each. "
        f"{sum(row['right'] for row in rows)} of {len(rows)} named exactly. Differs by: rms "
        "difference of x1 between the recorded run and another real run, over its standard deviation; the "
        "last of the three is what two runs of the very same spec differ by. In brackets: seconds until a "
        "sample of one of the two was late, since the machine stood still: from there on runs of one spec "
        f"differ, too. Each run was made up to {header['attempts']} times until none was.",
        "",
        "| hidden | verdict | found | as specified differs by | as patched differs by | repeated |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        told = (row["runs"][name] for name in ("nominal", "patched", "repeated"))
        differs = " | ".join(f"{one['differs']:.2g} ({one['until']:.3g} s)" for one in told)
        found = ", ".join(f"{one['block']} {one['kind']}" for one in row["found"]) or "nothing"
        lines.append(
            f"| {row['hidden']['block']} {row['hidden']['kind']} | {row['verdict']} | {found} | {differs} |"
        )
    return "\n".join(lines) + "\n"


def _undisturbed(options: argparse.Namespace) -> dict[int, dict[str, Any]]:
    """Rows of the table so far, of as long runs, in which no sample was late to the end."""
    file = options.out.with_suffix(".json")
    told = json.loads(file.read_text()) if file.exists() else {}
    rows = told["runs"] if told.get("duration") == options.duration else []
    least = ALMOST * options.duration
    return {number: row for number, row in enumerate(rows) if _exact(row) > least}


def _exact(row: dict[str, Any]) -> float:
    """Seconds in which none of a row's runs had a late sample."""
    return min((one["until"] for one in row.get("runs", {}).values()), default=0.0)


def main(words: list[str] | None = None) -> int:
    """Make the table; 1 when an effect was not named."""
    options = arguments(words)
    header = {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": f"{os.cpu_count()} cores ({platform.machine()}), Python {platform.python_version()}",
        "duration": options.duration,
        "attempts": options.attempts,
    }
    rows, undisturbed = list[dict[str, Any]](), _undisturbed(options)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="hidden-") as folder:
        plain = run(shipped_spec(NOMINAL), Path(folder) / "plain", options)
        for number in range(options.runs):
            row = undisturbed.get(number) or case(number, plain, Path(folder) / str(number), options)
            rows.append(row)
            print(
                row["hidden"], "->", row["found"], f"until {_exact(row):.3g} s", file=sys.stderr, flush=True
            )
            options.out.with_suffix(".json").write_text(json.dumps(header | {"runs": rows}, indent=1) + "\n")
            options.out.with_suffix(".md").write_text(markdown(header, rows))
    return 0 if all(row["right"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
