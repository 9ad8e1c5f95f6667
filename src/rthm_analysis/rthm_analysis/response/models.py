"""Frequency responses without sampling: the ideal system, delays alone, delays and holds, first order.

All return matrices (W, N, N), m/N, from loads on the plant's and then the numerical dofs to the positions of
the same dofs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.lifted.matrices import LinearLoop
from rthm_core.compiled import Floats
from rthm_core.engine.coupled.body import coupled_body
from rthm_core.loads import NO_LOAD
from rthm_core.physical.model import physical_model
from rthm_core.schedule import Schedule

if TYPE_CHECKING:
    from rthm_core.spec import Spec

Complex = np.ndarray
"""Array of complex numbers."""


class Paths(NamedTuple):
    """Total delays of the ways that a signal can take, s.

    Attributes
    ----------
    state_to_numerical : float
        tau2: z1 in the force on the numerical substructure.
    state_to_motor : float
        tau14: x1 in the position cancellation.
    state_in_force : float
        tau234: z1 in the force reference.
    numerical_in_force : float
        tau34: z2 in the force reference.
    """

    state_to_numerical: float
    state_to_motor: float
    state_in_force: float
    numerical_in_force: float


def paths(spec: Spec, *, holds: bool) -> Paths:
    """Delays of (30); with `holds`, every tau is the tau' of (20).

    The hold Td2 counts once on each way: z1 in the force reference passes it as part of tau2', z2 as part of
    tau3', as in (24).
    """
    schedule = Schedule(spec)
    tau1, tau2, tau3, tau4 = (link.delay_ns * 1e-9 for link in schedule.links.values())
    tau4 += schedule.motor_delay * 1e-9
    td1, td2, td3, td4 = (
        0.5e-9 * period * holds for period in (schedule.td1, schedule.td2, schedule.td3, schedule.td4)
    )
    tau1, tau2, late = tau1 + td1 + td3, tau2 + td1 + td2, tau3 + td4 + tau4
    return Paths(tau2, tau1 + tau4, tau2 + late, td2 + late)


def coupled(spec: Spec, system: str, omega: Floats) -> Complex:
    """Response of the ideal system (9), or of its first-order approximation (25), (26)."""
    body = coupled_body(spec, system)
    model, _ = physical_model(spec, body=body, further=[(NO_LOAD, dof) for dof in range(body.dofs)])
    a, inputs = model.whole.a, model.whole.b[:, 1:]  # the first load is the spec's own
    return np.stack([_transfer(a, inputs, 1j * w)[: body.dofs] for w in omega])


def delayed(loop: LinearLoop, ways: Paths, omega: Floats) -> Complex:
    """Response of (28), (29): continuous signals, pure delays; for n dofs, m actuators and linear effects."""
    return np.stack([_delayed_at(loop, ways, 1j * w) for w in omega])


def once_round(loop: LinearLoop, ways: Paths, s: complex) -> Complex:
    """What becomes of the commands once round the loop (m, m), in the model of `delayed`."""
    late = [np.exp(-s * delay) for delay in ways]
    command = _command_of_state(loop, late, _transfer(loop.a2, loop.b2, s))
    return np.asarray(command @ loop.sampled @ _transfer(loop.a1, loop.b1, s))


def _command_of_state(loop: LinearLoop, late: list[complex], by_held: Complex) -> Complex:
    """Command (m, 2 m) that the controller makes of what is sampled; `by_held`: z2 of the held motion."""
    m = loop.actuators
    from_state = late[2] * loop.force_held + late[3] * late[0] * loop.force_state @ by_held
    command = loop.flexibility[:, None] * from_state
    command[:, :m] += late[1] * np.eye(m)
    return np.asarray(command)


def _delayed_at(loop: LinearLoop, ways: Paths, s: complex) -> Complex:
    m, n1, n2 = loop.actuators, loop.position1.shape[0], loop.position2.shape[0]
    late = [np.exp(-s * delay) for delay in ways]
    by_command, by_load1 = np.split(_transfer(loop.a1, np.hstack([loop.b1, loop.l1]), s), [m], axis=1)
    by_held, by_load2 = np.split(_transfer(loop.a2, np.hstack([loop.b2, loop.l2]), s), [2 * m], axis=1)
    command = _command_of_state(loop, late, by_held)
    command_of_load = loop.flexibility[:, None] * (late[3] * loop.force_state @ by_load2)
    outside = loop.sampled @ np.hstack([by_load1, by_command @ command_of_load])
    state = np.linalg.solve(np.eye(2 * m) - loop.sampled @ by_command @ command, outside)
    u = command @ state + np.hstack([np.zeros((m, n1)), command_of_load])
    x1 = loop.position1 @ (by_command @ u + np.hstack([by_load1, np.zeros((by_load1.shape[0], n2))]))
    x2 = loop.position2 @ (
        late[0] * by_held @ state + np.hstack([np.zeros((by_load2.shape[0], n1)), by_load2])
    )
    return np.vstack([x1, x2])


def _transfer(a: Floats, b: Floats, s: complex) -> Complex:
    return np.asarray(np.linalg.solve(s * np.eye(a.shape[0]) - a, b))
