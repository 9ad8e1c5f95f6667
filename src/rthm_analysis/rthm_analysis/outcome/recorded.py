"""The verdict on a recorded test."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.energy import EnergyResult
from rthm_analysis.outcome.cycles import energy_per_cycle
from rthm_analysis.outcome.ideal import IdealError, error_of
from rthm_analysis.outcome.margin import margin_or_why
from rthm_analysis.outcome.outcome import Lateness, Outcome
from rthm_analysis.recording import Recording
from rthm_analysis.timing import RecordedSchedule
from rthm_core.engine import Trajectory, simulate
from rthm_core.errors import InputError
from rthm_core.topics import COMMAND

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

REACHED = 1.0 - 1e-9
"""Part of a limit from which it counts as touched: a command that is held back ends up on it."""

REPEATED = 600.0
"""Longest test that is simulated once more along its delays, s."""


def outcome_of(
    recording: Recording, ideal: Trajectory | None, energy: EnergyResult | None = None
) -> Outcome | None:
    """What a recorded test is worth; None for one that is no loop.

    Parameters
    ----------
    recording : Recording
        With its spec.
    ideal : Trajectory, optional
        Motion of the ideal system over the same time; None: the recording does not have its start.
    energy : EnergyResult, optional
        Where the energy came from; None: not known.
    """
    spec = recording.spec
    if spec is None or not spec.is_loop:
        return None
    errors = {} if ideal is None else _errors(recording, spec, ideal)
    lateness = None if ideal is None else _lateness(recording, spec, ideal)
    per_cycle = None if energy is None else _per_cycle(recording, spec, energy)
    return Outcome(margin_or_why(spec), errors, lateness, _touched(recording, spec), per_cycle)


def _per_cycle(recording: Recording, spec: Spec, energy: EnergyResult) -> float | None:
    """Work of the errors in each cycle of the first dof of the plant."""
    assert spec.plant is not None
    time = (recording.plant.stamp_ns - recording.start_ns) * 1e-9
    motion = recording.plant.columns("position", spec.plant.dofs[:1])[:, 0]
    return energy_per_cycle(energy.t, energy.error, np.interp(energy.t, time, motion))


def _errors(recording: Recording, spec: Spec, ideal: Trajectory) -> dict[str, IdealError]:
    """Error of the recorded motion of every dof of the plant."""
    assert spec.plant is not None
    time = (recording.plant.stamp_ns - recording.start_ns) * 1e-9
    found = {}
    for i, dof in enumerate(spec.plant.dofs):
        seen = recording.plant.columns("position", [dof])[:, 0]
        known = np.isfinite(seen)
        if known.any():
            there = np.interp(time[known], ideal.t, ideal.plant_position[:, i])
            found[dof] = error_of(seen[known] - there, there)
    return found


def _lateness(recording: Recording, spec: Spec, ideal: Trajectory) -> Lateness | None:
    """What the samples that were late changed; None where the delays that the test had are not recorded."""
    if recording.duration > REPEATED:
        return None
    sample = float(ideal.t[1] - ideal.t[0])
    try:
        schedule = RecordedSchedule(spec, recording)
        end = min(schedule.end * 1e-9, float(ideal.t[-1]))
        asked = simulate(spec, end, sample, energies=False)
        had = simulate(spec, end, sample, energies=False, schedule=schedule)
    except InputError:
        return None
    rows = min(len(asked.t), len(had.t), len(ideal.t))
    changed = (had.plant_position - asked.plant_position)[:rows]
    worst = max(error_of(*pair).nrmse for pair in zip(changed.T, ideal.plant_position[:rows].T, strict=True))
    return Lateness(worst)


def _touched(recording: Recording, spec: Spec) -> tuple[str, ...]:
    """Limits of the spec that the test reached, and the one that ended it."""
    ended = [recording.abort.limit] if recording.abort else []
    if spec.limits is None:
        return tuple(ended)
    largest = _largest(recording, spec)
    limits = {name: getattr(spec.limits, name) for name in largest}
    reached = [
        name for name, limit in limits.items() if limit is not None and largest[name] >= REACHED * limit
    ]
    return tuple(dict.fromkeys([*ended, *reached]))


def _largest(recording: Recording, spec: Spec) -> dict[str, float]:
    """Largest values in a recording, by the limit that each is for."""
    assert spec.plant is not None and spec.actuator is not None
    dofs, names, plant = spec.plant.dofs, spec.actuator.names, recording.plant
    found = {
        "position": _most(plant.columns("position", dofs)),
        "velocity": _most(plant.columns("velocity", dofs)),
        "measured_force": _most(plant.columns("effort", names)),
    }
    commands = recording.tables.get(COMMAND)
    if commands is not None:
        u_d = commands.columns("position", names)
        waits = np.maximum(np.diff(commands.stamp_ns), 1)[:, None] * 1e-9
        found |= {"command": _most(u_d), "rate": _most(np.diff(u_d, axis=0) / waits)}
    return found


def _most(values: Floats) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))
