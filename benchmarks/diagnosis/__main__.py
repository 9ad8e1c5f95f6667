"""Time the diagnosis of a minute of the paper's loop: ``python -m benchmarks.diagnosis --out PATH``."""

from __future__ import annotations

import argparse
import io
import json
import os
import platform
import resource
import subprocess
import sys
import tarfile
import tempfile
import time
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from benchmarks.rigs import RTHM, virtual_bag

from rthm_core.effects import load_effects
from rthm_core.spec import Spec, apply, shipped_spec, write_spec

NOMINAL = "paper_noisy"
UNLISTED = Path(__file__).with_name("unlisted.py")


def on_plant(kind: str, **parameters: float) -> dict[str, Any]:
    """Section of an effect on x1."""
    return {"block": "plant", "kind": kind, "dof": "x1"} | parameters


def hidden(**sections: dict[str, Any]) -> dict[str, Any]:
    """Changes of a spec by which it has these effects."""
    return {"effects": list(sections)} | sections


FRICTION = on_plant("coulomb_friction", force=0.03)
DRAG, SPRING = on_plant("quadratic_drag", coefficient=0.1), on_plant("cubic_stiffness", coefficient=20.0)
LOOPS = on_plant("bouc_wen", alpha=0.5, A=1.0, beta=2.0, gamma=1.0, n=1.0)
WIRE = {"block": "wire", "kind": "backlash", "actuator": "a1", "gap": 0.002}
HIDDEN: dict[str, dict[str, Any]] = {
    "nothing": {},
    "dry friction of 0.03 N": hidden(friction=FRICTION),
    "dry friction, drag and a cubic spring": hidden(friction=FRICTION, drag=DRAG, spring=SPRING),
    "hysteresis": hidden(loops=LOOPS),
    "backlash of the wire": hidden(wire=WIRE),
}
"""What is hidden in the plant or its wire."""

UNLISTED_KINDS: dict[str, dict[str, float]] = {
    "parametric_spring": {"stiffness": 0.8, "frequency": 2.2},
    "fading_spring": {"stiffness": 0.8, "begin": 9.0},
    "drifting_spring": {"rate": 0.0033},
    "cogging": {"force": 0.03, "pitch": 0.03},
    "magnet": {"strength": 0.01, "place": 0.7},
    "rubbing_place": {"force": 0.06, "width": 0.03},
    "damped_place": {"damping": 0.4, "begin": 0.05, "end": 0.2},
    "seal": {"force": 0.08, "begin": 15.0, "end": 25.0},
    "van_der_pol": {"coefficient": 4.7},
    "wind": {"force": 0.02},
}
"""Laws of no library (`unlisted`), with their parameters; they are hidden in a test under a known load."""

LOAD = {"kind": "multisine", "rms": 1.0, "low": 0.8, "high": 7.0, "count": 12, "seed": 4}

COMPARED = ("nothing", "dry friction of 0.03 N")
"""What another version of the code is timed with, too."""

OTHER_ROUNDS = 2
"""Times that everything else is diagnosed."""


def arguments(words: list[str] | None) -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.diagnosis", description=__doc__)
    parser.add_argument(
        "--out", type=Path, required=True, help="path without ending: .json and .md are written"
    )
    parser.add_argument("--duration", type=float, default=60.0, help="length of the recordings, s")
    parser.add_argument("--rounds", type=int, default=5, help="times that each is diagnosed")
    parser.add_argument(
        "--beside",
        metavar="COMMIT",
        help="time the code of a commit in turn with today's where it is compared",
    )
    return parser.parse_args(words)


class Case(NamedTuple):
    """A test as specified, and what is hidden in it: changes of its spec."""

    name: str
    nominal: Spec
    changes: dict[str, Any]


def cases() -> Iterator[Case]:
    """Everything that is timed: kinds of the library in a free decay, others under a known load."""
    nominal = shipped_spec(NOMINAL)
    for name, changes in HIDDEN.items():
        yield Case(name, nominal, changes)
    nominal = apply(nominal, {"load": {"plant": LOAD}})
    for kind, parameters in UNLISTED_KINDS.items():
        changes = {"effects_from": [str(UNLISTED)]} | hidden(unlisted=on_plant(kind, **parameters))
        yield Case(f"{kind.replace('_', ' ')} (no library)", nominal, changes)


def recorded(case: Case, folder: Path, duration: float) -> tuple[Path, Path]:
    """Bag of a run of the node graph in simulated time, and the spec with which it is diagnosed."""
    folder.mkdir()
    true, nominal = folder / "true.yaml", folder / "nominal.yaml"
    true.write_text(write_spec(apply(case.nominal, case.changes)), encoding="utf-8")
    nominal.write_text(write_spec(case.nominal), encoding="utf-8")
    return virtual_bag(true, duration), nominal


def sources_of(commit: str, folder: Path) -> str:
    """Search path of Python for the packages of a commit, which are unpacked into a folder."""
    packed = subprocess.run(["git", "archive", commit, "src"], capture_output=True, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")
    return os.pathsep.join(str(package) for package in sorted((folder / "src").iterdir()))


def diagnosed(bag: Path, spec: Path, environment: Mapping[str, str]) -> tuple[float, float, str]:
    """Wall and CPU time in s of the whole command, start and reading included, and what it found."""
    begin, before = time.perf_counter(), children_cpu()
    done = subprocess.run(
        [*RTHM, "diagnose", str(bag), "--spec", str(spec), "--json", "-"],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    seconds, cpu = time.perf_counter() - begin, children_cpu() - before
    said = json.loads(done.stdout)
    names = ", ".join(f"{one['block']} {one['kind']}" for one in said["physics"])
    formulas = ", ".join(f"`{one['formula']}`" for one in said.get("described", ()) if one["formula"])
    return seconds, cpu, names or formulas or said["verdict"]


def children_cpu() -> float:
    """CPU time of all processes that were waited for, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measured(options: argparse.Namespace, folder: Path) -> list[dict[str, Any]]:
    """One row per recording and version of the code; its first diagnosis of all compiles."""
    codes = {"today": dict(os.environ)}
    codes["today"].pop("PYTHONDONTWRITEBYTECODE", None)  # a second start of a user's finds bytecode
    if options.beside:
        codes[options.beside] = codes["today"] | {"PYTHONPATH": sources_of(options.beside, folder / "beside")}
    codes = {
        code: environment | {"RTHM_CACHE_DIR": str(folder / f"cache-{code}")}
        for code, environment in codes.items()
    }
    load_effects([UNLISTED])
    rows: list[dict[str, Any]] = []
    for number, case in enumerate(cases()):
        name = case.name
        bag, spec = recorded(case, folder / str(number), options.duration)
        there = codes if name in COMPARED else {"today": codes["today"]}
        firsts = {code: diagnosed(bag, spec, environment) for code, environment in there.items()}
        rounds = [
            {code: diagnosed(bag, spec, environment) for code, environment in there.items()}
            for _ in range(options.rounds if name in COMPARED else OTHER_ROUNDS)
        ]
        for code, (seconds, _, found) in firsts.items():
            warm, cpu = ([one[code][i] for one in rounds] for i in (0, 1))
            cold = None if number else seconds
            rows.append(
                {"hidden": name, "code": code, "found": found, "cold": cold, "warm": warm, "cpu": cpu}
            )
            print(rows[-1], file=sys.stderr, flush=True)
    return rows


def markdown(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    """Page of the results."""
    beside = f" --beside {header['beside']}" if header["beside"] else ""
    lines = [
        "# Time of a diagnosis",
        "",
        f"{header['date']}, {header['machine']}; `rthm diagnose` of {header['duration']:g} s of {NOMINAL}, "
        "time of the whole command: start, reading, every kind tried. First use: nothing is compiled. What "
        "is in no library acts in a test under a known load, the others in a free decay.",
        *(["Another version of the code was timed in turn with today's."] if beside else []),
        f"Again: `python -m benchmarks.diagnosis --out docs/diagnosis_time{beside}`.",
        "",
        "| hidden | code | found | first use | later, median | later, each | CPU, median |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        cold = f"{row['cold']:.1f} s" if row["cold"] else ""
        each = ", ".join(f"{seconds:.1f}" for seconds in row["warm"])
        later = f"{median(row['warm']):.1f} s | {each} s | {median(row['cpu']):.1f} s"
        lines.append(f"| {row['hidden']} | {row['code']} | {row['found']} | {cold} | {later} |")
    return "\n".join(lines) + "\n"


def main(words: list[str] | None = None) -> int:
    """Measure and write."""
    options = arguments(words)
    header = {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": f"{os.cpu_count()} cores ({platform.machine()}), Python {platform.python_version()}",
        "duration": options.duration,
        "beside": options.beside,
    }
    with tempfile.TemporaryDirectory(prefix="diagnosis-") as folder:
        rows = measured(options, Path(folder))
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.with_suffix(".json").write_text(json.dumps(header | {"rows": rows}, indent=1) + "\n")
    options.out.with_suffix(".md").write_text(markdown(header, rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
