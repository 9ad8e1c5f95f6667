"""By how much the stamps that a receiver read differ from those that the sender wrote.

Samples come at fixed periods, so stamps alone tell a shift only up to whole periods; which sample was really
used is told by its values, which are recorded without loss. Motors tell which command was, as they follow it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.links import (
    COMMAND_MISFIT_RATIO,
    EQUAL_VALUES_RATIO,
    FORESEEN_SHARE,
    SAMPLE_MISFIT_RATIO,
    SHIFT_FEWEST_VALUES,
    SHIFT_REACHES_NS,
    SHIFT_USES,
    SHIFT_VOTES_SHARE,
    SHIFT_VOTES_TO_BEST,
)
from rthm_analysis.recording import LinkTable, Recording, Table, hold, rows_of
from rthm_core.substructure import interface
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec


def stamp_offset(recording: Recording, spec: Spec, name: str, source: Table) -> int | None:
    """Stamps as the receiver of link `name` read them minus the sender's, ns; None: no shift fits.

    Parameters
    ----------
    source : Table
        Topic of the samples that go over the link.
    """
    uses = recording.links[name]
    if not (len(uses) and len(source)):
        return None
    some = np.unique(np.linspace(0, len(uses) - 1, SHIFT_USES).astype(np.int64))
    for reach in SHIFT_REACHES_NS:
        shifts = _shifts(source.stamp_ns, uses.sample_ns[some], reach)
        if not shifts.size:
            continue
        nearest = int(shifts[np.argmin(np.abs(shifts))])
        if shifts.size == 1:
            return nearest
        if name == "tau4":
            return _told_by_motors(recording, spec, source, shifts, nearest)
        return _told_by_values(recording, spec, name, uses.rows(some), shifts, nearest)
    return None


def sent_stamps(recording: Recording, spec: Spec, name: str, source: Table) -> Integers:
    """Stamps of the samples that the receiver of link `name` used, as their sender wrote them, ns."""
    return recording.links[name].sample_ns - (stamp_offset(recording, spec, name, source) or 0)


def _shifts(source: Integers, used: Integers, reach: int) -> Integers:
    """Shifts within `reach` with which most `used` stamps are stamps of the source, as far as any."""
    first = np.searchsorted(source, used - reach)
    counts = np.searchsorted(source, used + reach, side="right") - first
    rows = np.repeat(first - np.cumsum(counts) + counts, counts) + np.arange(int(counts.sum()))
    shifts, votes = np.unique(np.repeat(used, counts) - source[rows], return_counts=True)
    inside = (used - reach >= source[0]) & (used + reach <= source[-1])
    enough = SHIFT_VOTES_SHARE * max(int(np.count_nonzero(inside)), used.size // 2)
    return np.asarray(shifts[votes >= max(enough, SHIFT_VOTES_TO_BEST * votes.max(initial=0))])


def _told_by_values(
    recording: Recording, spec: Spec, name: str, uses: LinkTable, shifts: Integers, nearest: int
) -> int:
    """Shift whose samples have the values that the receiver computed with, or else the `nearest`."""
    equation = {"tau1": _controller, "tau2": _numerical, "tau3": _reference}.get(name)
    parts = equation(recording, spec, uses) if equation else None
    if parts is None:
        return nearest
    table, columns, others, target = parts
    misfits = {nearest: _misfit(table, columns, others, target, uses.sample_ns - nearest)}
    known = target[np.isfinite(target)]
    if not known.size or misfits[nearest] < EQUAL_VALUES_RATIO * float(np.sqrt(np.mean(known**2))):
        return nearest
    for shift in shifts[np.argsort(np.abs(shifts), kind="stable")]:
        if (uses.sample_ns - shift > uses.use_ns).mean() > FORESEEN_SHARE:
            continue  # Nobody uses samples of the future; a compensator only looks as if it did.
        misfits[int(shift)] = _misfit(table, columns, others, target, uses.sample_ns - shift)
    return _clearly_best(misfits, nearest, SAMPLE_MISFIT_RATIO)


def _told_by_motors(recording: Recording, spec: Spec, source: Table, shifts: Integers, nearest: int) -> int:
    """Shift with whose commands the motors go on from where they are, or else the `nearest`."""
    names = spec.actuator.names if spec.actuator else ()
    motors = recording.plant.columns("position", names)
    if nearest == 0 or not np.isfinite(motors).any():
        return nearest
    uses = recording.links["tau4"]
    order, commands = np.argsort(uses.use_ns, kind="stable"), source.columns("position", names)

    def misfit(shift: int) -> float:
        used = hold(source.stamp_ns, commands, uses.sample_ns[order] - shift)
        followed = hold(uses.use_ns[order], used, recording.plant.stamp_ns)
        return sum(_not_followed(u, u_d) for u, u_d in zip(motors.T, followed.T, strict=True))

    misfits = {shift: misfit(shift) for shift in shifts.tolist()}
    return _clearly_best(misfits, nearest, COMMAND_MISFIT_RATIO)


def _clearly_best(misfits: dict[int, float], nearest: int, share: float) -> int:
    """Shift with the least misfit if that is less than a share of the nearest's, or else the `nearest`."""
    best = min(misfits, key=lambda shift: misfits[shift])
    return best if misfits[best] < share * misfits[nearest] else nearest


def _not_followed(motor: Floats, command: Floats) -> float:
    """Rms that the commands and a motor's last position leave of its positions, whatever its lag."""
    basis, wanted = np.column_stack([command[1:], command[:-1], motor[:-1]]), motor[1:]
    known = np.isfinite(basis).all(axis=1) & np.isfinite(wanted)
    return _left_by(basis[known], wanted[known]) if known.any() else 0.0


def _misfit(table: Table, columns: Floats, others: Floats, target: Floats, stamps: Integers) -> float:
    """Rms that the best linear combination of these samples and the other signals leaves of `target`."""
    row, there = rows_of(table.stamp_ns, stamps)
    basis = np.column_stack([columns[row], others])[there]
    known = np.isfinite(basis).all(axis=1) & np.isfinite(target[there]).all(axis=1)
    if np.count_nonzero(known) < SHIFT_FEWEST_VALUES:
        return np.inf
    return _left_by(basis[known], target[there][known])


def _left_by(basis: Floats, wanted: Floats) -> float:
    """Rms that the best linear combination of the columns of a basis leaves."""
    left = wanted - basis @ np.linalg.lstsq(basis, wanted, rcond=None)[0]
    return float(np.sqrt(np.mean(np.square(left))))


Equation = tuple[Table, "Floats", "Floats", "Floats"]


def _controller(recording: Recording, spec: Spec, uses: LinkTable) -> Equation | None:
    """u_d is x1 as used plus a part of F_d as used."""
    commands = recording.tables.get(COMMAND)
    if commands is None or spec.loop().actuator.compensator != "none":
        return None
    row = np.maximum(np.searchsorted(commands.stamp_ns, uses.use_ns, side="right") - 1, 0)
    columns = recording.plant.columns("position", spec.loop().interface.plant_dof)
    return recording.plant, columns, commands.effort[row], commands.position[row]


def _numerical(recording: Recording, spec: Spec, uses: LinkTable) -> Equation | None:
    """F_d combines z1 as used with z2."""
    states = recording.tables.get(NUMERICAL_STATE)
    forces = recording.tables.get(FORCE_REFERENCE)
    if states is None or forces is None or len(states) != len(forces):
        return None
    row = np.maximum(np.searchsorted(states.stamp_ns, uses.use_ns, side="right") - 1, 0)
    dofs = spec.loop().interface.plant_dof
    motion = [recording.plant.columns(field, dofs) for field in ("position", "velocity")]
    at = interface(spec).numerical
    z2 = np.hstack([states.position[:, at], states.velocity[:, at]])
    return recording.plant, np.hstack(motion), z2[row], forces.effort[row]


def _reference(recording: Recording, spec: Spec, uses: LinkTable) -> Equation | None:
    """A command tells the F_d that it was computed with."""
    commands = recording.tables.get(COMMAND)
    forces = recording.tables.get(FORCE_REFERENCE)
    if commands is None or forces is None:
        return None
    row = np.maximum(np.searchsorted(commands.stamp_ns, uses.use_ns, side="right") - 1, 0)
    return forces, forces.effort, np.empty((len(uses), 0)), commands.effort[row]
