"""Compensators: what delayed samples will have become when the motor acts on them.

Both terms of the command are predicted, x1 of the position cancellation and F_d of the force feedforward.

``taylor`` takes the linear error terms (22)-(24) of the paper out, with the mean age of each sample at the
wire, holds included. With the measured velocity and backward differences for the rates,

``x1 + T_x v1`` and ``F_d + T_F dF_d/dt - T_z (k2 v1 + c2 dv1/dt)``.

``polynomial`` lays polynomials through the latest samples at their stamps and reads them at the middle t of
the time for which the commands of the controller's present period will act,

``x1(t)`` and ``F_d(t) - k2 (x1(t) - x1(t - T_z)) - c2 (v1(t) - v1(t - T_z))``.

T_z is the age of the plant's motion within a force reference, which is older than its stamp. What the
numerical substructure itself feels of the delays is not the controller's to change.
"""

from __future__ import annotations

from typing import NamedTuple

from rthm_core.compiled import Floats, called, copy_into

HIGHEST_ORDER = 4
"""Of the polynomials of a compensator."""

ENTRY, ORDER, HORIZON = "compensator", "compensator_order", "compensator_horizon"
"""Entries of the section `actuator` of a spec that state a compensator."""


class Compensator(NamedTuple):
    """A kind of compensator.

    Attributes
    ----------
    name : str
        In the spec.
    entries : tuple of str
        Entries of the section `actuator` with which it computes, its own among them.
    """

    name: str
    entries: tuple[str, ...]

    @property
    def predicts(self) -> bool:
        """Whether it does anything."""
        return HORIZON in self.entries

    @property
    def orders(self) -> range:
        """Orders that it may have; none where it has no order."""
        return range(1, HIGHEST_ORDER + 1) if ORDER in self.entries else range(0)

    def samples(self, order: int) -> int:
        """Number of latched samples of each signal that it looks at; 0: it does not predict."""
        return order + 1 if self.orders else 2 if self.predicts else 0


COMPENSATORS = (
    Compensator("none", (ENTRY,)),
    Compensator("taylor", (ENTRY, HORIZON)),
    Compensator("polynomial", (ENTRY, ORDER, HORIZON)),
)
NONE, TAYLOR, POLYNOMIAL = range(len(COMPENSATORS))
"""Codes of the kinds: their places in `COMPENSATORS`."""

NAMES = tuple(one.name for one in COMPENSATORS)

RESERVED = ("ats", "model", "inverse", "passivity")
"""Names that a spec may state although none of them is available yet."""


def declared(name: str) -> Compensator | None:
    """The kind of this name; None where it is not available."""
    return next((one for one in COMPENSATORS if one.name == name), None)


class Compensation(NamedTuple):
    """Compensator for compiled code.

    Attributes
    ----------
    code, order : int
        Which compensator; order of the polynomials.
    position_horizon, force_horizon : float
        T_x and T_F: mean ages of x1 and of F_d at the wire, holds included, in s.
    motion_age : float
        T_z: mean age of the plant's motion in a force reference at its stamp, in s.
    way : float
        Time from a command to its effect at the wire, without hold, in s.
    period : int
        Period of the controller, in ns.
    stiffness, damping : (m,) arrays
        k2 and c2 of the interface, N/m and N s/m.
    """

    code: int
    order: int
    position_horizon: float
    force_horizon: float
    motion_age: float
    way: float
    period: int
    stiffness: Floats
    damping: Floats


def started(how: Compensation, position: Floats, velocity: Floats, force: Floats) -> tuple[Floats, Floats]:
    """Position and force reference (m,) on which a controller acts that has seen nothing but these, and this
    velocity.
    """
    if how.code == TAYLOR:
        return position + how.position_horizon * velocity, force - how.motion_age * how.stiffness * velocity
    return position, force


@called
def compensated(controller, now, position, force):  # type: ignore[no-untyped-def]
    """Write the plant position (m,) and the force reference (m,) that the controller acts on from `now` (ns)
    on.
    """
    copy_into(position, controller.position[0])
    copy_into(force, controller.force[0])
    if controller.compensation.code == TAYLOR:
        _linear(controller, position, force)
    elif controller.compensation.code == POLYNOMIAL:
        _polynomial(controller, now, position, force)


@called
def _linear(controller, position, force):  # type: ignore[no-untyped-def]
    how = controller.compensation
    between = (controller.state_stamp[0] - controller.state_stamp[1]) * 1e-9
    references = (controller.force_stamp[0] - controller.force_stamp[1]) * 1e-9
    for i in range(position.size):
        velocity = controller.velocity[0, i]
        acceleration = (velocity - controller.velocity[1, i]) / between
        rate = (controller.force[0, i] - controller.force[1, i]) / references
        position[i] += how.position_horizon * velocity
        force[i] += how.force_horizon * rate
        force[i] -= how.motion_age * (how.stiffness[i] * velocity + how.damping[i] * acceleration)


@called
def _polynomial(controller, now, position, force):  # type: ignore[no-untyped-def]
    """Read the polynomials where the controller's present period has its middle, on the wire's side."""
    how = controller.compensation
    ahead = how.way + (0.5 * how.period - now % how.period) * 1e-9
    for i in range(position.size):
        position[i], force[i] = 0.0, 0.0
    for j in range(how.order + 1):
        then = weight(controller.state_stamp, j, how.order, now, ahead)
        before = weight(controller.state_stamp, j, how.order, now, ahead - how.motion_age)
        reference = weight(controller.force_stamp, j, how.order, now, ahead)
        for i in range(position.size):
            moved = how.stiffness[i] * controller.position[j, i] + how.damping[i] * controller.velocity[j, i]
            position[i] += then * controller.position[j, i]
            force[i] += reference * controller.force[j, i] - (then - before) * moved


@called
def weight(stamps, j, order, now, ahead):  # type: ignore[no-untyped-def]
    """Weight of sample `j` in the polynomial through samples 0 to `order` at their `stamps` (ns), a time
    `ahead` (s) of the instant `now` (ns): Lagrange's formula.
    """
    product = 1.0
    for k in range(order + 1):
        if k != j:
            product *= (ahead + (now - stamps[k]) * 1e-9) / ((stamps[j] - stamps[k]) * 1e-9)
    return product
