"""Measured recordings of real rigs, diagnosed: ``python -m benchmarks.recorded FOLDER --out docs/recorded``.

FOLDER holds bags and CSV files that are no part of the project; beside each lies its nominal spec. What a
model made by hand leaves is known from those who published the recordings, or was worked out once.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.concealed.table import machine

from rthm_analysis.recording import read_recording

RTHM = Path(sys.executable).parent / "rthm"
HEAD = """# Recordings of real rigs

What `rthm diagnose` says of measured recordings, made on {date} ({machine}) by
`python -m benchmarks.recorded FOLDER --out docs/recorded`. Errors are those of a free run over the last
third, which no fit has seen, over the standard deviation of the signal there; of the positioning axis (EMPS),
which drifts for want of a spring, those of short runs, with which no model made by hand compares. The model
made by hand is the physics that is known to be in the rig, fitted by somebody who knew it. Of several
recordings of one rig, diagnosed together, the last is the unseen part.

{titles}
|---|---|---|---|---|---|---|---|---|
"""
TITLES = ("recording", "verdict", "named, and described", "as specified", "retuned", "explained", "by hand",
          "noise", "CPU, s")  # fmt: skip


@dataclass(frozen=True)
class Recorded:
    """A recording.

    Parameters
    ----------
    path
        In the folder, without ending.
    by_hand
        Error of a model made by hand: in the signal's unit, or over its standard deviation; None: not known.
    relative
        Whether it is the latter.
    columns
        How to import it; empty for a bag.
    before
        Recordings of the same rig that are diagnosed together with it: it confirms what they show.
    """

    path: str
    by_hand: float | None
    relative: bool = False
    columns: tuple[str, ...] = ()
    before: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """As it is called in the table."""
        return ", ".join([*self.before, self.path])


PENDULUM = ("--map", "position:x1=Theta", "--time", "Time")
DRONE = ("--map", "position:x1=theta", "--map", "load:x1=u", "--time", "t")
RECORDINGS = (
    Recorded("emps_identification", None),
    Recorded("emps_validation", None),
    Recorded("silverbox_multisine", 0.91e-3),
    Recorded("silverbox_arrow", 0.96e-3),
    Recorded("hysteresis_multisine", 6.1e-6),
    Recorded("hysteresis_sweep", 2.5e-6),
    Recorded("pendulum/small", 1.2e-3, columns=PENDULUM),
    Recorded("pendulum/mid", 0.020, True, PENDULUM),
    Recorded("pendulum/large", 0.20, True, PENDULUM),
    Recorded("pendulum/mid", 0.0623, True, PENDULUM, ("pendulum/small", "pendulum/large")),
    Recorded("drone/multisine", 0.139, True, DRONE),
    Recorded("drone/steps", 0.128, True, DRONE),
)


def diagnosed(one: Recorded, folder: Path, scratch: Path) -> dict[str, Any]:
    """Return the diagnosis of a recording, and its CPU seconds."""
    bags = [_bag(path, one.columns, folder, scratch) for path in (*one.before, one.path)]
    begin = _cpu()
    words = [RTHM, "diagnose", *bags, "--spec", folder / f"{one.path}.yaml", "--json", "-"]
    said = json.loads(subprocess.run(words, capture_output=True, text=True, check=False).stdout)
    unseen = [fit["held_out"] for fit in said["fits"] if fit["signal"].startswith("x")][:1]
    return said | {"cpu": _cpu() - begin, "by_hand": _by_hand(one, bags[-1], unseen)}


def _bag(path: str, columns: tuple[str, ...], folder: Path, scratch: Path) -> Path:
    """A recording as a bag, imported where it is none."""
    bag = scratch / path.replace("/", "_") if columns else folder / path
    if not bag.exists():
        words = [RTHM, "import", folder / f"{path}.csv", "--out", bag, *columns]
        subprocess.run(words, check=True, capture_output=True)
    return bag


def _by_hand(one: Recorded, bag: Path, unseen: list[list[float]]) -> str:
    """Error of the model made by hand, over the standard deviation of the unseen part."""
    if one.by_hand is None or not unseen:
        return ""
    (begin, end), plant = unseen[0], read_recording(bag).plant
    time = 1e-9 * (plant.stamp_ns - plant.stamp_ns[0])
    there = plant.position[(time >= begin) & (time <= end), 0]
    size = 1.0 if one.relative or one.before else float(np.nanstd(there))
    return f"{100.0 * one.by_hand / size:.3g} %"


def _cpu() -> float:
    """CPU seconds of all children that have ended."""
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def row(one: Recorded, said: dict[str, Any]) -> str:
    """Return one line of the table."""
    named = [entry["kind"].replace("_", " ") for entry in said["physics"]]
    curves = [f"curve over {' and '.join(entry['depends_on'])}" for entry in said["described"]]
    fits = [fit["nrmse"] for fit in said["fits"] if fit["signal"].startswith("x")][:1]
    keys = ("nominal", "retuned", "explained")
    errors = [f"{100.0 * fits[0][key]:.3g} %" if fits else "" for key in keys]
    noise = f"{100.0 * fits[0]['noise_floor']:.2g} %" if fits else ""
    cells = [one.name, said["verdict"], ", ".join(named + curves), *errors, said["by_hand"], noise]
    return f"| {' | '.join(cells)} | {said['cpu']:.0f} |\n"


def main() -> int:
    """Make the page and the numbers behind it."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.recorded", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--out", type=Path, required=True, help="path without ending: .md and .json are written"
    )
    options = parser.parse_args()
    lines, numbers = [], {}
    with tempfile.TemporaryDirectory(prefix="recorded-") as scratch:
        for one in RECORDINGS:
            begin = time.perf_counter()
            said = diagnosed(one, options.folder, Path(scratch))
            numbers[one.name] = {k: said[k] for k in ("verdict", "physics", "described", "retuned", "fits")}
            lines.append(row(one, said))
            print(f"{lines[-1].strip()} {time.perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)
    date = f"{datetime.now(UTC):%Y-%m-%d}"
    head = HEAD.format(date=date, machine=machine(), titles=f"| {' | '.join(TITLES)} |")
    options.out.with_suffix(".md").write_text(head + "".join(lines))
    kept = {"date": date, "machine": machine(), "recordings": numbers}
    options.out.with_suffix(".json").write_text(json.dumps(kept, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
