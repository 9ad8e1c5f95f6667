"""Motion of a recorded test."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.comparison.motion import Motion, Signal, signal
from rthm_analysis.comparison.simulated import Names, names_of
from rthm_analysis.energy import energy_of
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.topics import COMMAND, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def motion_of_recording(name: str, recording: Recording, beside: Spec | None = None) -> Motion:
    """Motion of a recording.

    Parameters
    ----------
    name : str
        As the source was called.
    recording : Recording
    beside : Spec, optional
        Whose names are taken where the recording has no spec.

    Raises
    ------
    InputError
        It has no position of a dof.
    """
    spec = recording.spec or beside
    names = names_of(spec) if spec is not None else _names_in(recording)
    signals = _measured(recording, names) | _commanded(recording, names)
    dofs = tuple(dof for dof in (*names.plant, *names.numerical) if dof in signals)
    if not dofs:
        there = ", ".join(recording.plant.names)
        raise InputError(
            f"{name} has no position of {', '.join(names.plant) or 'a dof'}, only the names {there}; record"
            " it, or rename it with rthm import."
        )
    energies, passed, notes = _balance(recording)
    return Motion(
        name,
        "recording",
        signals | energies,
        dofs,
        names.actuators,
        recording.spec,
        recording,
        passed,
        (*recording.notes, *notes),
    )


def _names_in(recording: Recording) -> Names:
    """Names of a recording that no spec explains: what pulls is an actuator, what only moves is a dof; where
    all that moves pulls as well, as under known loads, it is a dof.
    """
    plant, numerical = recording.plant, recording.tables.get(NUMERICAL_STATE)
    moving = _known(plant.names, plant.position)
    pulling = _known(plant.names, plant.effort)
    dofs = tuple(name for name in moving if name not in pulling) or moving
    computed = tuple(name for name in numerical.names if name not in dofs) if numerical else ()
    actuators = tuple(name for name in pulling if name not in dofs)
    return Names(dofs, computed, actuators, tuple(range(len(dofs))))


def _known(names: tuple[str, ...], values: Floats) -> tuple[str, ...]:
    """Names whose column of values (n, k) is known anywhere."""
    return tuple(name for name, column in zip(names, values.T, strict=True) if np.isfinite(column).any())


def _measured(recording: Recording, names: Names) -> dict[str, Signal]:
    """Positions of dofs and motors, and forces in the wires."""
    plant, numerical = recording.plant, recording.tables.get(NUMERICAL_STATE)
    at_ns = plant.stamp_ns - recording.start_ns
    found: dict[str, Signal] = {}
    for dof in names.plant:
        found |= signal(dof, "m", at_ns, plant.columns("position", [dof])[:, 0])
    if numerical is not None:
        ticks_ns = numerical.stamp_ns - recording.start_ns
        for dof in names.numerical:
            found |= signal(dof, "m", ticks_ns, numerical.columns("position", [dof])[:, 0])
    for one in names.actuators:
        found |= signal(f"{one}.motor", "m", at_ns, plant.columns("position", [one])[:, 0])
        found |= signal(f"{one}.force", "N", at_ns, plant.columns("effort", [one])[:, 0])
    return found


def _commanded(recording: Recording, names: Names) -> dict[str, Signal]:
    """Commands, and the force references in them, both held."""
    table = recording.tables.get(COMMAND)
    found: dict[str, Signal] = {}
    if table is None:
        return {}
    at_ns = table.stamp_ns - recording.start_ns
    for one in names.actuators:
        found |= signal(f"{one}.command", "m", at_ns, table.columns("position", [one])[:, 0], held=True)
        found |= signal(f"{one}.reference", "N", at_ns, table.columns("effort", [one])[:, 0], held=True)
    return found


def _balance(recording: Recording) -> tuple[dict[str, Signal], Signal | None, tuple[str, ...]]:
    """Energies, the integral of the squared velocity, and what could not be told of them."""
    if recording.spec is None:
        return {}, None, ()
    try:
        balance = energy_of(recording, recording.spec)
    except InputError as reason:
        return {}, None, (str(reason),)
    at_ns = np.rint(balance.t * NS).astype(np.int64)
    found: dict[str, Signal] = {}
    for term, work in (balance.work | {"E_err": balance.error, "E_total": balance.total}).items():
        found |= signal(term, "J", at_ns, work)
    return found, signal("passed", "m^2/s", at_ns, balance.passed).get("passed"), balance.notes
