"""Compensators: how the controller predicts what its delayed samples will have become when the motor acts on
them.

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

from math import gcd
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.clock import NS
from rthm_core.compiled import Floats, called, copy_into
from rthm_core.errors import InputError
from rthm_core.substructure import as_built, interface

if TYPE_CHECKING:
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import TimingSpec

NONE, TAYLOR, POLYNOMIAL = range(3)
CODES = {"none": NONE, "taylor": TAYLOR, "polynomial": POLYNOMIAL}
HIGHEST_ORDER = 4


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


def compensation(spec: Spec) -> Compensation:
    """Compensator of the spec with which the controller computes.

    Raises
    ------
    InputError
        When there is no compensator of this name.
    """
    loop, sides = spec.loop(), interface(spec)
    actuator, timing = loop.actuator, loop.timing
    if actuator.compensator not in CODES:
        raise InputError(
            f"actuator.compensator {actuator.compensator!r} is not available, allowed is one of "
            f"{', '.join(CODES)}; choose one of them."
        )
    way = actuator.compensator_horizon
    if way is None:
        way = timing.tau4 + sum(1.0 / pole for pole in actuator.motor_poles or ())
    return Compensation(
        CODES[actuator.compensator],
        actuator.compensator_order,
        mean_age(timing, "tau1", "td1", "td3") + 0.5 * timing.td3 + way,
        _reference_age(timing) + way,
        mean_age(timing, "tau2", "td1", "td2"),
        way,
        timing.ns("td3"),
        sides.stiffness,
        sides.damping,
    )


def mean_age(timing: TimingSpec, delay: str, sampled: str, used: str) -> float:
    """Mean age, in s, of the newest sample of one clock that has passed a delay, at the ticks of another.

    In phase, the age added by the first clock takes the multiples of the greatest common divisor of both
    periods: its mean is less than half a period.
    """
    tau, period = timing.ns(delay), timing.ns(sampled)
    common = gcd(period, timing.ns(used))
    return (tau + -tau % common + 0.5 * (period - common)) / NS


def _reference_age(timing: TimingSpec) -> float:
    """Mean age, in s, of the force reference in use, its hold included."""
    if timing.ns("td4") == 0:
        return timing.tau3 + 0.5 * timing.td2
    return mean_age(timing, "tau3", "td2", "td4") + 0.5 * timing.td4


def first_parts(spec: Spec) -> tuple[Floats, Floats]:
    """Both parts (m,) of the command in steady state before a test, in m: x1 and F_d / k_tot,
    compensated.

    Raises
    ------
    InputError
        When the spec describes no loop.
    """
    believed, computed = as_built(spec, "controller"), as_built(spec, "numerical")
    loop, sides, how = computed.loop(), interface(computed), compensation(believed)
    x1 = np.array(loop.plant.initial_position, dtype=float)[sides.plant]
    v1 = np.array(loop.plant.initial_velocity, dtype=float)[sides.plant]
    x2 = np.array(loop.numerical.initial_position, dtype=float)[sides.numerical]
    v2 = np.array(loop.numerical.initial_velocity, dtype=float)[sides.numerical]
    force = sides.force(x1, v1, x2, v2)
    if how.code == TAYLOR:
        x1, force = x1 + how.position_horizon * v1, force - how.motion_age * how.stiffness * v1
    return x1, force / np.array(believed.k_tot)


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
