"""Measure: ``python -m benchmarks.engine --out FOLDER`` writes speed.json and speed.md."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.concealed.table import machine
from benchmarks.engine import ours
from benchmarks.engine.clock import interleaved
from benchmarks.engine.cosimulation import co_simulated
from benchmarks.engine.dde import delayed
from benchmarks.engine.limit import NoCompilerError, event_engine
from benchmarks.engine.others import Entry, pade, restarted, runge_kutta
from benchmarks.engine.reference import reference
from benchmarks.engine.scale import (
    long_run,
    per_one,
    sensitive,
    stability_checks,
    starts,
    swept,
    with_delays,
    with_masses,
)
from benchmarks.engine.table import markdown
from benchmarks.engine.twin import kernel_and_twin

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.spec import Spec, shipped_spec

DURATION, SAMPLE = 20.0, 0.0012
LIMIT = "C event engine"


@dataclass
class Row:
    """One way: CPU seconds, ratio to the C engine, largest error of x1 in m, or why it was not measured."""

    name: str
    cpu: float | None = None
    ratio: float | None = None
    error: float | None = None
    skipped: str | None = None


def _c_engine(spec: Spec, duration: float, sample: float) -> Entry:
    call, rows = event_engine(spec, to_ns(duration), to_ns(sample))
    return call, lambda _: rows[:, 0]


WAYS: dict[str, Callable[[Spec, float, float], Entry]] = {
    LIMIT: _c_engine,
    "rthm_core, kernel": ours.kernel,
    "rthm_core, simulate()": ours.whole,
    "rthm_core, simulate() with energies": lambda *given: ours.whole(*given, energies=True),
    "RK4, 0.1 ms, numba": runge_kutta,
    "python-control, Pade of order 4": pade,
    "JiTCDDE, true sampling": lambda *given: delayed(*given, sampled=True),
    "JiTCDDE, true sampling, steps laid on the events": lambda *given: delayed(
        *given, sampled=True, step=4e-4
    ),
    "JiTCDDE, mean delays": lambda *given: delayed(*given, sampled=False),
    "FMPy co-simulation": co_simulated,
    "scipy solve_ivp, restarted": restarted,
}
SLOW = {
    "JiTCDDE, true sampling": 15,
    "JiTCDDE, true sampling, steps laid on the events": 15,
    "JiTCDDE, mean delays": 15,
    "FMPy co-simulation": 3,
    "scipy solve_ivp, restarted": 1,
}


def measured(spec: Spec, exact: Floats, rounds: int) -> list[Row]:
    """Every way through the paper's loop, beside the C engine."""
    rows, calls = {name: Row(name) for name in WAYS}, {}
    for name, way in WAYS.items():
        try:
            call, of = way(spec, DURATION, SAMPLE)
        except (ImportError, NoCompilerError) as reason:
            rows[name].skipped = str(reason)
            continue
        rows[name].error, calls[name] = float(np.abs(of(call()) - exact).max()), call
    _time(rows, calls, rounds)
    return list(rows.values())


def beyond(spec: Spec, rounds: int) -> list[Row]:
    """Loops beyond the paper's: what they cost in units of the paper's loop in C."""
    calls: dict[str, Callable[[], Any]] = {}
    with suppress(NoCompilerError):
        calls[LIMIT] = _c_engine(spec, DURATION, SAMPLE)[0]
    for name, other in (ours.further(spec) | ours.nonlinear(spec)).items():
        calls[name] = ours.whole(other, DURATION, SAMPLE)[0]
        calls[name + ", with energies"] = ours.whole(other, DURATION, SAMPLE, energies=True)[0]
    rows = {name: Row(name) for name in calls}
    for name, other in ours.nonlinear(spec).items():
        rows[name].error = ours.difference(other, DURATION, SAMPLE)
    _time(rows, calls, max(3, rounds // 5))
    return list(rows.values())


def beside_twins(spec: Spec, rounds: int) -> list[Row]:
    """Kernels of linear loops beside their twins in C: the ratio is to the twin, the error the difference."""
    rows: list[Row] = []
    for name, other in ({"the paper's loop": spec} | ours.repeating(spec)).items():
        try:
            kernel, twin = kernel_and_twin(other, DURATION, SAMPLE)
        except NoCompilerError as reason:
            return [Row(name, skipped=str(reason))]
        difference = float(np.abs(kernel().plant - twin()).max())
        times = interleaved({"kernel": kernel, "twin": twin}, max(3, rounds // 3), {})
        rows.append(Row(name, times.median("kernel"), times.ratio("kernel", "twin"), difference))
    return rows


def scaled(spec: Spec) -> dict[str, float]:
    """Many loops, a long loop, and the start of the program."""
    hour, added = long_run(spec, 3600.0, SAMPLE)
    first, later = starts()
    found = {"hour": hour, "hour_added_mb": added, "first_start": first, "later_start": later}
    seldom, often = None, None
    with suppress(NoCompilerError):
        seldom, often = (_c_engine(spec, DURATION, sample)[0] for sample in (1.0, SAMPLE))
    ensembles = {"per_loop": with_masses(spec, DURATION, 1.0), "own_delays": with_delays(spec, DURATION, 1.0)}
    found |= swept()
    return found | per_one(ensembles, seldom) | per_one({"check": stability_checks(spec)}, often)


def derivatives(spec: Spec) -> list[dict[str, Any]]:
    """Sensitivities to all parameters, by what a loop has."""
    loops = {"the paper's loop": spec, **ours.nonlinear(spec)}
    return [{"name": name} | sensitive(other, DURATION, SAMPLE) for name, other in loops.items()]


def _time(rows: dict[str, Row], calls: dict[str, Callable[[], Any]], rounds: int) -> None:
    times = interleaved(calls, rounds, SLOW)
    for name in calls:
        rows[name].cpu = times.median(name)
        rows[name].ratio = times.ratio(name, LIMIT) if LIMIT in calls else None


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.engine", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent, help="folder for the results")
    parser.add_argument("--rounds", type=int, default=51, help="rounds of the fast ways")
    given = parser.parse_args()
    spec = shipped_spec("paper")
    exact = reference(spec, to_ns(DURATION), to_ns(SAMPLE))[:, 0]
    found = {
        "date": datetime.now(UTC).date().isoformat(),
        "machine": machine(),
        "duration": DURATION,
        "sample": SAMPLE,
        "ways": [asdict(row) for row in measured(spec, exact, given.rounds)],
        "beyond": [asdict(row) for row in beyond(spec, given.rounds)],
        "twins": [asdict(row) for row in beside_twins(spec, given.rounds)],
        "derivatives": derivatives(spec),
        "scale": scaled(spec),
    }
    given.out.mkdir(parents=True, exist_ok=True)
    (given.out / "speed.json").write_text(json.dumps(found, indent=1) + "\n")
    (given.out / "speed.md").write_text(markdown(found))


if __name__ == "__main__":
    main()
