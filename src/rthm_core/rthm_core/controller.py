"""The actuator controller: position cancellation and force feedforward.

``u_d = x1 [zoh1, tau1, zoh3] + F_d [tau3, zoh4] / k_tot`` (paper, (6) and (11)); a compensator may predict
both terms (`rthm_core.compensators`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compensation import compensation
from rthm_core.compensators import HIGHEST_ORDER, Compensation, compensated
from rthm_core.compiled import Floats, Integers, called, compiled_in_place, copy_into
from rthm_core.lent import lent
from rthm_core.substructure import as_built, interface

if TYPE_CHECKING:
    from rthm_core.spec import Spec

HISTORY = HIGHEST_ORDER + 1
"""How many latched samples a compensator can look back on."""


class ControllerState(NamedTuple):
    """Controller for compiled code; row 0 of every history is the newest.

    Attributes
    ----------
    stiffness : (m,) array
        k_tot that the controller computes with, N/m.
    compensation : Compensation
        How delays are made up for.
    state_stamp, force_stamp : (HISTORY,) arrays
        Stamps of latched states and references, ns since the start.
    position, velocity, force : (HISTORY, m) arrays
        Latched samples: m, m/s, N.
    """

    stiffness: Floats
    compensation: Compensation
    state_stamp: Integers
    position: Floats
    velocity: Floats
    force_stamp: Integers
    force: Floats


def controller(spec: Spec) -> ControllerState:
    """Controller of a spec at the start of a test: it has held the initial state and F_c(z1(0), z2(0)) for
    ever.
    """
    believed = as_built(spec, "controller")
    computed = as_built(spec, "numerical")
    loop, sides = computed.loop(), interface(computed)
    x1, v1 = (
        np.array(loop.plant.initial_position)[sides.plant],
        np.array(loop.plant.initial_velocity)[sides.plant],
    )
    x2, v2 = (
        np.array(loop.numerical.initial_position)[sides.numerical],
        np.array(loop.numerical.initial_velocity)[sides.numerical],
    )
    past = -np.arange(1, HISTORY + 1, dtype=np.int64)
    return ControllerState(
        np.array(believed.k_tot, dtype=float),
        compensation(believed),
        past * loop.timing.ns("td1"),
        np.tile(x1.astype(float), (HISTORY, 1)),
        np.tile(v1.astype(float), (HISTORY, 1)),
        past * loop.timing.ns("td2"),
        np.tile(sides.force(x1, v1, x2, v2).astype(float), (HISTORY, 1)),
    )


@called
def latch_state(controller, stamp, position, velocity):  # type: ignore[no-untyped-def]
    """Take a state sample (m,) over from the link; the same sample again changes nothing."""
    if stamp > controller.state_stamp[0]:
        for k in range(controller.state_stamp.size - 1, 0, -1):
            controller.state_stamp[k] = controller.state_stamp[k - 1]
            copy_into(controller.position[k], controller.position[k - 1])
            copy_into(controller.velocity[k], controller.velocity[k - 1])
        controller.state_stamp[0] = stamp
        copy_into(controller.position[0], position)
        copy_into(controller.velocity[0], velocity)


@called
def latch_force(controller, stamp, force):  # type: ignore[no-untyped-def]
    """Take a force reference (m,) over from the link; the same sample again changes nothing."""
    if stamp > controller.force_stamp[0]:
        for k in range(controller.force_stamp.size - 1, 0, -1):
            controller.force_stamp[k] = controller.force_stamp[k - 1]
            copy_into(controller.force[k], controller.force[k - 1])
        controller.force_stamp[0] = stamp
        copy_into(controller.force[0], force)


@called
def control(controller, now, position_part, force_part):  # type: ignore[no-untyped-def]
    """Both parts of u_d (m,), in m: position cancellation and F_d / k_tot."""
    compensated(controller, now, position_part, force_part)
    for i in range(force_part.size):
        force_part[i] /= controller.stiffness[i]


@compiled_in_place
def _latch_state(controller: ControllerState, stamp: int, position: Floats, velocity: Floats) -> None:
    latch_state(lent(controller), stamp, position, velocity)


@compiled_in_place
def _latch_force(controller: ControllerState, stamp: int, force: Floats) -> None:
    latch_force(lent(controller), stamp, force)


@compiled_in_place
def _command(controller: ControllerState, now: int, out: Floats, force: Floats) -> None:
    compensated(lent(controller), now, out, force)
    for i in range(out.size):
        out[i] += force[i] / controller.stiffness[i]


class Controller:
    """The controller as an object: what the actuator node and the tests hold.

    All instants are ns since the start of the test.

    Raises
    ------
    InputError
        When the spec describes no loop.
    """

    def __init__(self, spec: Spec) -> None:
        self.compiled = controller(spec)
        self._force = self.compiled.force[0].copy()

    def latch_state(self, stamp_ns: int, position: Floats, velocity: Floats) -> None:
        """Use the plant's motion (m,) at the interface dofs from now on."""
        _latch_state(
            self.compiled,
            stamp_ns,
            np.ascontiguousarray(position, dtype=float),
            np.ascontiguousarray(velocity, dtype=float),
        )

    def latch_force(self, stamp_ns: int, force: Floats) -> None:
        """Use the force reference (m,) from now on."""
        _latch_force(self.compiled, stamp_ns, np.ascontiguousarray(force, dtype=float))

    def command(self, now_ns: int) -> Floats:
        """u_d (m,), in m."""
        out = np.empty(self.compiled.stiffness.size)
        _command(self.compiled, now_ns, out, self._force)
        return out

    @property
    def force(self) -> Floats:
        """F_d (m,) in the last command, in N; with a compensator, as it was predicted."""
        return np.array(self._force)
