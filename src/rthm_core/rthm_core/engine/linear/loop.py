"""A loop without anything nonlinear, as the matrices of its two sides.

Known loads become states of their own (a sinusoid is a rotation), so that both sides are driven by held
values alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compensators import NONE
from rthm_core.compiled import Floats, Integers
from rthm_core.controller import controller
from rthm_core.loads import Loads
from rthm_core.numerical import shared_numerical
from rthm_core.physical.drive import LIMIT, QUANTUM, RATE
from rthm_core.physical.laws import DOF
from rthm_core.physical.sensors import Sensors
from rthm_core.physical.side import first_command, read_only, shared_model
from rthm_core.substructure import interface

if TYPE_CHECKING:
    from rthm_core.physical.advance import Physical
    from rthm_core.spec import Spec


class Exosystem(NamedTuple):
    """Loads as the output of an autonomous linear system ``ds/dt = a s``, ``load = out s``."""

    a: Floats
    out: Floats
    loads: Loads

    def state(self, t: float) -> Floats:
        """State at time `t` in s."""
        amplitude, frequency, phase, _ = self.loads.sines.T
        angle = frequency * t + phase
        waves = np.stack([amplitude * np.sin(angle), amplitude * np.cos(angle)], axis=1).ravel()
        return np.concatenate([waves, self.loads.constant[self.loads.constant != 0.0]])


class Side(NamedTuple):
    """One side of a linear loop: ``d[y, s]/dt = a [y, s] + b held``.

    Attributes
    ----------
    a, b : arrays
        Dynamics and effect of the held inputs.
    y, held : arrays
        State without loads, and held inputs, at the start of a test.
    exosystem : Exosystem
        Loads s.
    """

    a: Floats
    b: Floats
    y: Floats
    held: Floats
    exosystem: Exosystem

    def state(self, t: float) -> Floats:
        """State [y, s] with the present y and the loads of time `t` in s."""
        return np.concatenate([self.y, self.exosystem.state(t)])


class LinearLoop(NamedTuple):
    """Both sides, and what passes between them.

    Attributes
    ----------
    plant, numerical : Side
        Held inputs are the commands (m,), and the latched motion (2 m,).
    sample : (2 m, .) array
        Measured motion at the interface from [y, s, commands]; without bias, drift, noise and rounding.
    bias : (2 m,) array
        What is added to every sample.
    sensors : Sensors or None
        Rows of `sample` with noise, drift or rounding; None when there are none.
    rows : (2 n1 + m, .) array
        Position, velocity and wire force from [y, s, commands].
    motors : (m, .) array
        Positions of the motors from [y, s, commands].
    reference : (m, .) array
        F_d from [y, s, held] of the numerical side.
    k_tot : (m,) array
        What the controller computes with, N/m.
    first_sample, first_reference : (2 m,), (m,) arrays
        The steady state before the test.
    """

    plant: Side
    numerical: Side
    sample: Floats
    bias: Floats
    sensors: Sensors | None
    rows: Floats
    motors: Floats
    reference: Floats
    k_tot: Floats
    first_sample: Floats
    first_reference: Floats


def exosystem(loads: Loads) -> Exosystem | None:
    """Loads as a linear system; None where that is not possible: tables and ramps."""
    if loads.table_time.size or np.any(loads.sines[:, 3] > 0.0):
        return None
    waves, constants = loads.which.size, np.flatnonzero(loads.constant)
    size = 2 * waves + constants.size
    a, out = np.zeros((size, size)), np.zeros((loads.constant.size, size))
    for i, (load, w) in enumerate(zip(loads.which, loads.sines[:, 1], strict=True)):
        a[2 * i, 2 * i + 1], a[2 * i + 1, 2 * i] = w, -w
        out[load, 2 * i] = 1.0
    out[constants, 2 * waves + np.arange(constants.size)] = 1.0
    return Exosystem(a, out, loads)


def with_loads(ab: Floats, y: Floats, held: Floats, loads: Exosystem) -> Side:
    """Side with the inputs [held, loads] as one with held inputs alone."""
    n, m, size = ab.shape[0], held.size, loads.a.shape[0]
    a, b = np.zeros((n + size, n + size)), np.zeros((n + size, m))
    a[:n, :n], a[:n, n:], a[n:, n:] = ab[:, :n], ab[:, n + m :] @ loads.out, loads.a
    b[:n] = ab[:, n : n + m]
    return Side(a, b, y.copy(), held.copy(), loads)


def linear_loop(spec: Spec) -> LinearLoop | None:
    """Matrices of a loop; None where something in it is not linear or not of constant coefficients."""
    return linear_part(spec) if shared_model(spec)[0].laws is None else None


def linear_part(spec: Spec) -> LinearLoop | None:
    """The same without the plant's laws that are not linear; wires that are not linear have no force here."""
    physical, number, control = read_only(spec), shared_numerical(spec), controller(spec)
    one, two = exosystem(physical.model.loads), exosystem(number.loads)
    if one is None or two is None or control.compensation.code != NONE or _has_limits(physical):
        return None
    sides = interface(spec)
    plant = with_loads(physical.model.whole.ab, physical.state.whole, first_command(spec), one)
    second = with_loads(number.system.ab, number.y, number.held, two)
    sample, bias, measured = _samples(physical, plant)
    x1, v1 = np.array(spec.plant.initial_position), np.array(spec.plant.initial_velocity)
    return LinearLoop(
        plant,
        second,
        sample,
        bias,
        measured,
        _rows(physical, plant),
        _motors(physical, plant),
        _reference(number.n, sides.numerical, number.stiffness, number.damping, second),
        control.stiffness,
        np.concatenate([x1[sides.plant], v1[sides.plant]]).astype(float),
        control.force[0].copy(),
    )


def _has_limits(physical: Physical) -> bool:
    """Whether commands are changed, rounded or limited."""
    drive = physical.model.drive
    shape, changed = drive.conditioning, drive.shifts.numbers.size > 0
    return bool(changed or np.any(shape[QUANTUM] != 0.0) or np.any(np.isfinite(shape[[LIMIT, RATE]])))


def _samples(physical: Physical, side: Side) -> tuple[Floats, Floats, Sensors | None]:
    """Rows of the samples, their bias, and their sensors where these do more."""
    model = physical.model
    n, m, nq = model.n, model.m, physical.state.q.size
    dofs = model.wires.numbers[:, DOF]
    channels = np.concatenate([dofs, n + dofs])
    lagged, values = model.sensors.lagged[channels], model.sensors.values[channels]
    rows = np.zeros((2 * m, side.a.shape[0] + m))
    plain = bool(np.all(values[:, 2:] == 0.0))
    rows[np.arange(2 * m), nq + np.where(lagged >= 0, lagged, channels)] = values[:, 0] if plain else 1.0
    if plain:
        return rows, values[:, 1].copy(), None
    none = np.full(2 * m, -1, dtype=np.int64)
    return rows, np.zeros(2 * m), Sensors(values.copy(), none, model.sensors.key[channels])


def _rows(physical: Physical, side: Side) -> Floats:
    """Position, velocity and wire force."""
    model = physical.model
    n, m, nq, ny = model.n, model.m, physical.state.q.size, physical.state.y.size
    size = side.a.shape[0]
    rows = np.zeros((2 * n + m, size + m))
    rows[: 2 * n, nq : nq + 2 * n] = np.eye(2 * n)
    rows[2 * n :, nq : nq + ny] = model.wires.force[:, :ny]
    rows[2 * n :, :nq] = model.wires.force[:, ny:] @ model.drive.out[:, :nq]
    rows[2 * n :, size:] = model.wires.force[:, ny:] @ model.drive.out[:, nq:]
    return rows


def _motors(physical: Physical, side: Side) -> Floats:
    """Positions of the motors."""
    out, nq, size = physical.model.drive.out, physical.state.q.size, side.a.shape[0]
    rows = np.zeros((out.shape[0], size + physical.model.m))
    rows[:, :nq], rows[:, size:] = out[:, :nq], out[:, nq:]
    return rows


def _reference(n: int, dofs: Integers, stiffness: Floats, damping: Floats, side: Side) -> Floats:
    """F_d = F_c between the held motion of the plant and the present one of the numerical side."""
    m, size = stiffness.size, side.a.shape[0]
    rows, each = np.zeros((m, size + 2 * m)), np.arange(m)
    rows[each, dofs], rows[each, n + dofs] = stiffness, damping
    rows[each, size + each], rows[each, size + m + each] = -stiffness, -damping
    return rows
