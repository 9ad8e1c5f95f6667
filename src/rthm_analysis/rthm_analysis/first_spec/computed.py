"""What the parts of a loop compute with: interface, numerical substructure and the controller's k_tot.

What they take in and give out is recorded, so this follows exactly, by linear least squares without noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.first_spec.matrices import Matrices, fitted_matrices
from rthm_analysis.recording import rows_of
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording, Table
    from rthm_core.compiled import Floats, Integers

LEFT_BY_ITS_LAW = 1e-3
"""Part of a signal that a law leaves which is not the one that was computed with."""


LATE = 0.5
"""Part of its period by which a tick may be late for a use to be one of it."""


@dataclass(frozen=True)
class Connection:
    """One actuator's connection of the substructures.

    Attributes
    ----------
    plant_dof, numerical_dof : str
    stiffness, damping : float
        N/m, N s/m.
    left : float
        Part of the force reference that it leaves.
    """

    plant_dof: str
    numerical_dof: str
    stiffness: float
    damping: float
    left: float


@dataclass(frozen=True)
class Ticks:
    """What the numerical side knew at some of its ticks.

    Attributes
    ----------
    number : (t,) array
        Rows of ``numerical/state``.
    x1, v1 : (t, n) arrays
        Motion of the plant that it used.
    x2, v2, load : (t, k) arrays
        Its own motion and load.
    force : (t, m) array
        Force references.
    stamp_ns : (t,) array
    """

    number: Integers
    x1: Floats
    v1: Floats
    x2: Floats
    v2: Floats
    load: Floats
    force: Floats
    stamp_ns: Integers


def ticks_of(recording: Recording, dofs: tuple[str, ...], actuators: tuple[str, ...]) -> Ticks | None:
    """What was used at each tick of the numerical side; None where that is not recorded."""
    plant, own = recording.plant, recording.tables[NUMERICAL_STATE]
    used = _used(recording, "tau2", own)
    if used is None:
        return None
    tick, sample = used
    reference = recording.tables[FORCE_REFERENCE]
    row, there = rows_of(reference.stamp_ns, own.stamp_ns[tick])
    tick, sample, row = tick[there], sample[there], row[there]
    return Ticks(
        tick,
        plant.columns("position", dofs)[sample],
        plant.columns("velocity", dofs)[sample],
        own.position[tick],
        own.velocity[tick],
        np.nan_to_num(own.effort[tick]),
        reference.columns("effort", actuators)[row],
        own.stamp_ns[tick],
    )


def _used(recording: Recording, link: str, receiver: Table) -> tuple[Integers, Integers] | None:
    """Rows of a receiver's table, and of the plant's samples that it used there.

    In real time a tick is a little late, but stamped as what it is.
    """
    uses, plant = recording.links.get(link), recording.plant
    if uses is None or not len(uses):
        return None
    at = np.maximum(np.searchsorted(receiver.stamp_ns, uses.use_ns, side="right") - 1, 0)
    late = uses.use_ns - receiver.stamp_ns[at]
    sample, recorded = rows_of(plant.stamp_ns, uses.sample_ns)
    period = np.median(np.diff(receiver.stamp_ns)) if len(receiver) > 1 else 1.0
    known = (late >= 0) & (late < LATE * period) & recorded
    return (at[known], sample[known]) if known.any() else None


def connections(
    ticks: Ticks, dofs: Sequence[str], numerical: Sequence[str], actuators: Sequence[str]
) -> list[Connection]:
    """The connection of each actuator: of all pairs of dofs the one that the force references are of."""
    found = []
    for k, _ in enumerate(actuators):
        force, ways = ticks.force[:, k], []
        for (i, dof), (j, other) in product(enumerate(dofs), enumerate(numerical)):
            columns = np.column_stack([ticks.x2[:, j] - ticks.x1[:, i], ticks.v2[:, j] - ticks.v1[:, i]])
            known = np.isfinite(columns).all(axis=1) & np.isfinite(force)
            solved, left = _solved(columns[known], force[known])
            ways.append(Connection(dof, other, float(solved[0]), float(solved[1]), left))
        found.append(min(ways, key=lambda way: way.left))
    return found


def controller_stiffness(
    recording: Recording, actuators: Sequence[str], wires: Sequence[str]
) -> list[float | None]:
    """The k_tot, N/m, that the controller computes with; None where it does not do what the contract says.

    Parameters
    ----------
    actuators, wires : sequence of str
        Names, and the dof at which each pulls.
    """
    sent = recording.tables[COMMAND]
    used = _used(recording, "tau1", sent)
    if used is None:
        return [None] * len(actuators)
    tick, sample = used
    moved = sent.columns("position", actuators)[tick] - recording.plant.columns("position", wires)[sample]
    force, found = sent.columns("effort", actuators)[tick], []
    for k, _ in enumerate(actuators):
        known = np.isfinite(moved[:, k]) & np.isfinite(force[:, k])
        solved, left = _solved(force[known, k : k + 1], moved[known, k])
        found.append(float(1.0 / solved[0]) if left < LEFT_BY_ITS_LAW and solved[0] > 0.0 else None)
    return found


def numerical_matrices(ticks: Ticks, connected: Sequence[int]) -> Matrices | None:
    """Matrices of the numerical substructure; None where its motion is not that of a linear structure.

    Between two ticks it sees the plant held: its motion from tick to tick is a matrix, and the rate of that
    matrix has accelerations that are as exact as the motion.

    Parameters
    ----------
    ticks : Ticks
    connected : sequence of int
        Number of the numerical dof that each actuator is connected to.
    """
    from scipy.linalg import logm

    n = ticks.x2.shape[1]
    period = int(np.median(np.diff(ticks.stamp_ns)))
    next_one = np.flatnonzero(np.diff(ticks.stamp_ns) == period)
    loads = ticks.load[:, np.ptp(ticks.load, axis=0) > 0.0]
    growth = np.diff(loads, axis=0, append=loads[-1:])
    state, inputs = np.hstack([ticks.x2, ticks.v2]), np.hstack([ticks.x1, ticks.v1])
    columns = np.hstack([state, inputs, loads, growth])
    known = next_one[np.isfinite(columns[next_one]).all(axis=1)]
    if known.size < 3 * columns.shape[1]:
        return None
    sizes = np.maximum(np.abs(columns[known]).max(axis=0), 1e-300)
    step = np.linalg.lstsq(columns[known] / sizes, state[known + 1], rcond=None)[0].T / sizes
    left = state[known + 1] - columns[known] @ step.T
    if not np.sqrt(np.mean(np.square(left))) < LEFT_BY_ITS_LAW * np.std(np.diff(state[known], axis=0)):
        return None
    whole = np.eye(columns.shape[1])
    whole[: 2 * n] = step
    if loads.size:  # loads grow along straight lines from tick to tick
        at = np.arange(-2 * loads.shape[1], -loads.shape[1])
        whole[at, at + loads.shape[1]] = 1.0
    rate = np.real(logm(whole))[n : 2 * n] / (period * 1e-9)
    acceleration = columns[known] @ rate.T
    force = ticks.load[known].copy()
    for k, dof in enumerate(connected):
        force[:, dof] -= ticks.force[known, k]
    return fitted_matrices((acceleration, ticks.v2[known], ticks.x2[known]), force, [None] * n)


def _solved(columns: Floats, values: Floats) -> tuple[Floats, float]:
    """Least squares, and the part of the values that it leaves."""
    solved = np.asarray(np.linalg.lstsq(columns, values, rcond=None)[0], dtype=float)
    size = float(np.sqrt(np.mean(np.square(values)))) if values.size else 0.0
    left = float(np.sqrt(np.mean(np.square(values - columns @ solved)))) if values.size else 0.0
    return solved, left / size if size else np.inf
