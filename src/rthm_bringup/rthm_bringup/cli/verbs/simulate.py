"""``rthm simulate``: the exact engine, without ROS."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rthm_bringup.cli.options import Amplitude, Effects, Json, SpecName
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.engine import Trajectory
    from rthm_core.schedule import Schedule
    from rthm_core.spec import Spec

EXAMPLES = (
    "rthm simulate paper --duration 20 --out paper.npz --plot paper.png",
    "rthm simulate paper --duration 20 --out paper.npz --sensitivity plant.mass",
)


class System(StrEnum):
    """What is simulated."""

    hybrid = "hybrid"
    ideal = "ideal"
    taylor = "taylor"


def verb(
    duration: Annotated[float, typer.Option(metavar="S", help="Length of the test in s.")],
    out: Annotated[Path, typer.Option(metavar="FILE.npz", help="Where to write the trajectory.")],
    spec: SpecName = "paper",
    sample: Annotated[
        float | None, typer.Option(metavar="S", help="Time between the rows in s; by default Td1.")
    ] = None,
    system: Annotated[
        System,
        typer.Option(
            help="hybrid: the loop; ideal: without delays and holds; taylor: first-order approximation "
            "of the delays (eq. 26)."
        ),
    ] = System.hybrid,
    as_recorded: Annotated[
        Path | None,
        typer.Option(metavar="BAG", help="Use the delays measured in this recording."),
    ] = None,
    sensitivity: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY",
            help="Also write the derivative of the motion with respect to this number of the spec, such as "
            "plant.mass; all: every number of the physics. Can be repeated.",
        ),
    ] = None,
    amplitude: Amplitude = 1.0,
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Also draw motion beside that of the ideal system, force and energy, as .png, .svg or .pdf.",
        ),
    ] = None,
    effects: Effects = None,
    json: Json = None,
) -> int:
    """Simulate a test exactly, and write its motion to an .npz file."""
    from rthm_analysis.outcome import IdealComparison, Outcome
    from rthm_bringup.cli.options import check_picture, spec_named
    from rthm_bringup.cli.output import progress_bar, put, table
    from rthm_bringup.cli.trajectory import check_room, trajectory_file
    from rthm_bringup.unstable import told_margin
    from rthm_core.files import check_place
    from rthm_core.spec import scaled_motion

    test = scaled_motion(spec_named(spec, effects), amplitude)
    if out.suffix != ".npz":
        name = out.with_suffix(".npz") if out.name else "motion.npz"
        raise InputError(
            f"--out is {out}, but a trajectory is written as .npz; name it {name}"
            " (`rthm export` writes recordings as CSV, MAT or Parquet)."
        )
    check_place("--out", out)
    check_room(out, test, duration, sample)
    if as_recorded is not None and (sensitivity or not test.is_loop or system is not System.hybrid):
        raise InputError(
            "--as-recorded is for a loop, with --system hybrid and without --sensitivity; leave out one "
            "or the other."
        )
    if plot is not None:
        check_picture(plot)
    schedule = None if as_recorded is None else _recorded_schedule(test, as_recorded)
    is_judged = test.is_loop and system is System.hybrid
    margin = told_margin(test) if is_judged else ""
    beside = IdealComparison(test, duration, sample) if is_judged else None
    lost = None
    with progress_bar("simulating", duration) as report, trajectory_file(out) as file:
        blocks, changes = _simulated(test, duration, sample, system, schedule, sensitivity or [])
        for block in blocks:
            file.add(block)
            lost = _lost_at(block) if lost is None else lost
            if beside is not None:
                beside.add(block)
            report(float(block.t[-1]))
        for name, change in changes.items():
            file.add_change(name, change)
    result = {"file": str(out), "duration": duration, "system": system.value, "energies": file.energies}
    result["lost_at"] = lost
    lines = [str(out), *table((name, _joules(value)) for name, value in file.energies.items())]
    if beside is not None:
        outcome = Outcome(margin, beside.errors(), energy_per_cycle=beside.energy_per_cycle())
        result["verdict"] = outcome.as_dict()
        lines += ["", *outcome.lines(warned=True)]
    if lost is not None:
        lines.append(f"The motion {_way_lost(test)} at {lost:.4g} s; no values after that.")
    if plot is not None:
        _draw(out, plot, beside.motion if beside else None)
        result["picture"] = str(plot)
        lines.insert(1, str(plot))
    put(result, lines, json)
    return 0


def _lost_at(block: Trajectory) -> float | None:
    """First instant, s, from which on there is no motion; None: there is."""
    from numpy import flatnonzero, isfinite

    lost = flatnonzero(~isfinite(block.plant_position).all(axis=1))
    return float(block.t[lost[0]]) if lost.size else None


def _way_lost(spec: Spec) -> str:
    """How a motion can be lost: it grows without bound, or goes where its mass is none."""
    from rthm_core.spec.masses import steady

    return "diverged, or its mass matrix was no longer positive definite," if steady(spec) else "diverged"


def _draw(out: Path, plot: Path, ideal: Trajectory | None) -> None:
    import numpy as np

    from rthm_analysis.report.trajectory_picture import draw

    with np.load(out) as columns:
        draw(columns, plot, ideal)


def _joules(value: float) -> str:
    return f"{value:+.3e} J" if isfinite(value) else "diverged"


def _simulated(
    test: Spec,
    duration: float,
    sample: float | None,
    system: System,
    schedule: Schedule | None,
    names: list[str],
) -> tuple[Iterator[Trajectory], dict[str, Trajectory]]:
    """Trajectory in blocks, and its derivatives with respect to some numbers of the spec."""
    from rthm_core.engine import sensitivities

    if not names:
        return _blocks(test, duration, sample, system, schedule), {}
    if not test.is_loop or system is not System.hybrid:
        raise InputError("--sensitivity is for a loop, with --system hybrid; leave out one or the other.")
    found = sensitivities(test, duration, None if names == ["all"] else names, sample)
    return iter([found.trajectory]), found.by_parameter


def _recorded_schedule(test: Spec, bag: Path) -> Schedule:
    """When which sample was used in a recorded test."""
    from rthm_analysis.recording import read_recording
    from rthm_analysis.timing import RecordedSchedule

    return RecordedSchedule(test, read_recording(bag))


def _blocks(
    test: Spec, duration: float, sample: float | None, system: System, schedule: Schedule | None
) -> Iterator[Trajectory]:
    """Trajectory in blocks, so that the memory needed does not grow with the duration of a loop."""
    from rthm_core.engine import simulate, simulate_blocks

    if test.is_loop and system is System.hybrid:
        return simulate_blocks(test, duration, sample, schedule=schedule)
    return iter([simulate(test, duration, sample, system.value)])
