"""Runs of the node graph by ``rthm run``, and what is read from them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from benchmarks.realtime.compare import exact_energies, payloads, worst_difference

from rthm_analysis.recording import read_recording
from rthm_core.spec import shipped_spec

TERMS = ("E_num", "E_ff", "E_fx", "E_err", "E_damping")
"""Energies that are compared; E_total is what is left of them."""

Figures = dict[str, Any]


def run(spec: str, duration: float, out: Path, *options: str) -> Figures:
    """Run a shipped test; return what ``rthm run --json`` tells.

    Raises
    ------
    RuntimeError
        It did not come to its end; with what was said.
    """
    command = [sys.executable, "-m", "rthm_bringup", "run", spec, "--duration", str(duration)]
    done = subprocess.run(
        [*command, "--out", str(out), "--json", "-", *options], capture_output=True, text=True, check=False
    )
    if not done.stdout.startswith("{"):
        raise RuntimeError(done.stderr.strip())
    told: Figures = json.loads(done.stdout)
    if told["wall"] is None:
        raise RuntimeError(" ".join(told["problems"]))
    return told


def in_real_time(spec: str, duration: float, folder: Path) -> Figures:
    """Figures of a run in real time, energies relative to the exact engine's."""
    told = run(spec, duration, folder / "real")
    exact = exact_energies(shipped_spec(spec), duration)
    lost = told["lost"] + sum(link["lost"] for link in told["links"].values())
    return {
        "priority": bool(told["realtime"]),
        "problems": told["problems"],
        "lost": lost,
        "missed_deadlines": told["missed_deadlines"],
        "excess": {name: link["excess"] for name, link in told["links"].items()},
        "excess_undisturbed": {name: link["excess_undisturbed"] for name, link in told["links"].items()},
        "late": {name: link["late"] for name, link in told["links"].items()},
        "energies": {term: {"run": told["energies"][term], "exact": exact[term]} for term in TERMS},
    }


def in_simulated_time(spec: str, duration: float, folder: Path) -> Figures:
    """Figures of two equal runs in simulated time, compared with the exact engine and with each other."""
    one, two = (run(spec, duration, folder / name, "--virtual") for name in ("first", "second"))
    first, second = payloads(Path(one["bag"])), payloads(Path(two["bag"]))
    return {
        "problems": one["problems"] + two["problems"],
        "speed": [duration / told["wall"] for told in (one, two)],
        "difference": worst_difference(read_recording(one["bag"]), shipped_spec(spec), duration),
        "messages": sum(len(data) for data in first.values()),
        "identical": first == second,
    }
