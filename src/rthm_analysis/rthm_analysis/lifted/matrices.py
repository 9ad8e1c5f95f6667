"""A linear loop as matrices, taken from the objects that the simulator computes with.

| plant, motors | dp/dt  = A1 p  + B1 u_d + L1 w1 | p = [motor chains, x1, v1, states of effects] |
| numerical     | dz2/dt = A2 z2 + B2 h   + L2 w2 | z2 = [x2, v2], h = held [x1, v1] at the interface |
| sample        | y      = C1 p                   | [position, velocity] at the interface, (2 m,) |
| reference     | F_d    = -k2 (h_x - x2) - c2 (h_v - v2) | |
| command       | u_d    = y_x + F_d / k_tot | |
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.lifted.predictor import Predictor, history, predictor
from rthm_core.compiled import Floats, Integers
from rthm_core.controller import controller
from rthm_core.kept import kept_without_timing
from rthm_core.numerical import shared_numerical
from rthm_core.physical.model import PhysicalModel
from rthm_core.physical.sensors import Sensors
from rthm_core.physical.side import shared_model
from rthm_core.substructure import as_built, interface, substructure

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class LinearLoop(NamedTuple):
    """Matrices of a linear loop with n1 and n2 dofs and m actuators; np physical states.

    Attributes
    ----------
    a1, b1, l1 : (np, np), (np, m), (np, n1) arrays
        Dynamics (1/s), effect of the commands, and of unit loads on the plant's dofs.
    position1 : (n1, np) array
        ``x1 = position1 p``.
    sampled : (2 m, np) array
        What the data acquisition reads: positions, then velocities, at the interface.
    a2, b2, l2, position2 : arrays
        The same of the numerical substructure; its inputs are the 2 m held values.
    force_held, force_state : (m, 2 m), (m, 2 n2) arrays
        ``F_d = force_held h + force_state z2``.
    flexibility : (m,) array
        1 / k_tot as the controller computes with it, m/N.
    predictor : Predictor or None
        Compensator of the controller.
    """

    a1: Floats
    b1: Floats
    l1: Floats
    position1: Floats
    sampled: Floats
    a2: Floats
    b2: Floats
    l2: Floats
    position2: Floats
    force_held: Floats
    force_state: Floats
    flexibility: Floats
    predictor: Predictor | None = None

    @property
    def history(self) -> int:
        """How many latched samples of each signal the controller looks at; 0: it does not predict."""
        return 0 if self.predictor is None else history(self.predictor.controller)

    @property
    def actuators(self) -> int:
        """Number m of actuators."""
        return int(self.flexibility.size)

    @property
    def fastest_oscillation(self) -> float:
        """Largest imaginary part of the poles of plant and numerical substructure, rad/s."""
        poles = np.concatenate([np.linalg.eigvals(self.a1), np.linalg.eigvals(self.a2)])
        return float(np.abs(poles.imag).max(initial=0.0))


def linear_loop(spec: Spec) -> LinearLoop:
    """Matrices of a loop that `linear_part` has left linear."""
    return _without_predictor(spec)._replace(predictor=predictor(spec))


@kept_without_timing
def _without_predictor(spec: Spec) -> LinearLoop:
    """Its matrices, in which no clock and no delay is."""
    model = _physical(spec)
    a1, b1 = model.whole.a.copy(), model.whole.b
    m, n1 = model.m, model.n
    computed = as_built(spec, "numerical")
    side, body = shared_numerical(spec), substructure(computed.loop().numerical)
    inverse_mass = np.linalg.inv(body.mass)
    n2, nq = side.n, a1.shape[0] - model.mechanics.shape[0]
    force_held, force_state = _reference_rows(interface(computed).numerical, side.stiffness, side.damping, n2)
    return LinearLoop(
        a1,
        b1[:, :m].copy(),
        _pushed(model, nq),
        np.eye(a1.shape[0])[nq : nq + n1],
        _sampled_rows(spec, model, nq),
        side.system.a.copy(),
        side.system.b[:, : 2 * m].copy(),
        np.vstack([np.zeros((n2, n2)), inverse_mass]),
        np.eye(2 * n2)[:n2],
        force_held,
        force_state,
        1.0 / controller(spec).stiffness,
    )


def _physical(spec: Spec) -> PhysicalModel:
    model, _ = shared_model(spec)
    if model.laws is not None:
        raise ValueError("the physical side is not linear")
    return model


def _pushed(model: PhysicalModel, nq: int) -> Floats:
    """Effect of unit loads on the plant's dofs on the rate of the physical states."""
    rows = np.zeros((nq + model.mechanics.shape[0], model.n))
    rows[nq + model.n : nq + 2 * model.n] = model.inverse_mass
    return rows


def _sampled_rows(spec: Spec, model: PhysicalModel, nq: int) -> Floats:
    dofs = interface(spec).plant
    rows = np.zeros((2 * model.m, nq + model.mechanics.shape[0]))
    for row, channel in enumerate([*dofs, *(model.n + dofs)]):
        at, gain = _reading(model.sensors, int(channel))
        rows[row, nq + at] = gain
    return rows


def _reading(sensors: Sensors, channel: int) -> tuple[int, float]:
    """State that a channel reads, and its gain."""
    lagged = int(sensors.lagged[channel])
    return (lagged if lagged >= 0 else channel), float(sensors.values[channel, 0])


def _reference_rows(dofs: Integers, k2: Floats, c2: Floats, n2: int) -> tuple[Floats, Floats]:
    m = k2.size
    held, state = np.hstack([-np.diag(k2), -np.diag(c2)]), np.zeros((m, 2 * n2))
    for a, dof in enumerate(dofs):
        state[a, dof], state[a, n2 + dof] = k2[a], c2[a]
    return held, state
