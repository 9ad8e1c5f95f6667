"""The physical side at the start of a test: motors, wires, laws and sensors in steady state."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats, Integers, uncompiled
from rthm_core.physical.advance import Physical, PhysicalState
from rthm_core.physical.drive import accepted, settled
from rthm_core.physical.integrate import trace, work
from rthm_core.physical.laws import DOF, PULLEY, Place
from rthm_core.physical.model import Mechanical, PhysicalModel, Resting
from rthm_core.physical.switching import first_mode, motion_of


def physical(
    model: PhysicalModel, resting: list[Resting], position: Floats, velocity: Floats, command: Floats
) -> Physical:
    """Physical side at the start of a test, in steady state: the motors at `command` (m,), the plant at
    `position` (n,).
    """
    nq, ny, laws = model.drive.system.ab.shape[0], model.mechanics.shape[0], mode_count(model)
    whole = np.zeros(nq + ny)
    q, y = whole[:nq], whole[nq:]
    first = accepted(model.drive, command[None], np.zeros(1))[0]
    q[:] = settled(model.drive, first)
    y[: model.n], y[model.n : 2 * model.n] = position, velocity
    rest(model, resting, y, model.drive.out @ np.concatenate([q, first]))
    inputs = np.zeros((model.whole.orders, model.whole.ab.shape[1] - nq - ny))
    state = PhysicalState(
        np.zeros(1, dtype=np.int64),
        whole,
        q,
        y,
        first.copy(),
        first.copy(),
        _first_modes(model, y),
        np.array([np.inf]),
        np.abs(y),
        inputs,
    )
    return Physical(model, state, work(ny, nq, model.m, model.load_dof.size, laws), trace(ny, laws))


def rest(model: PhysicalModel | Mechanical, resting: list[Resting], y: Floats, u: Floats) -> None:
    """Write the own states of pulleys, laws and sensors in steady state into `y` (ny,), whose positions and
    velocities are there, with the motors at `u` (m,).
    """
    wires = model.wires
    for actuator, row in enumerate(wires.numbers):
        if row[PULLEY] >= 0:
            k, nominal = wires.stiffness[actuator]
            soft = 1.0 / (1.0 / nominal - 1.0 / k)
            y[row[PULLEY]] = (soft * u[actuator] + k * y[row[DOF]]) / (soft + k)
    for law, p, place, at in resting:
        if isinstance(place, Place):
            y[at : at + law.states] = law.initial(place.apart(y), p)
        else:
            drive_position = wires.drive[place] @ np.concatenate([y, u])
            y[at : at + law.states] = law.initial(drive_position, y[wires.numbers[place, DOF]], p)
    _rest_sensors(model, y, u)


def _rest_sensors(model: PhysicalModel | Mechanical, y: Floats, u: Floats) -> None:
    """What lags behind a signal that is constant has its value."""
    wires, sensors = model.wires, model.sensors
    for row in np.flatnonzero(sensors.lagged >= 0).tolist():
        actuator = row - 2 * model.n
        force = (
            wires.stiffness[actuator, 1] * (u[actuator] - y[wires.numbers[actuator, DOF]])
            if actuator >= 0
            else 0.0
        )
        y[sensors.lagged[row]] = y[row] if actuator < 0 else force


def mode_count(model: PhysicalModel) -> int:
    """Number of modes: one per law that is not linear, one per wire (1: taut, -1: slack), and one per law of
    a wire (which way the path goes that it remembers).
    """
    return 0 if model.laws is None else len(model.laws.numbers) + model.m + len(model.wires.laws)


def _first_modes(model: PhysicalModel, y: Floats) -> Integers:
    modes = np.zeros(mode_count(model), dtype=np.int64)
    for row in range(0 if model.laws is None else model.laws.numbers.shape[0]):
        x, v = uncompiled(motion_of)(model.laws, model.n, row, y)
        modes[row] = uncompiled(first_mode)(model.laws, row, x, v)
    return modes
