"""The compensator of a spec: its horizons and ages, from the timing of the loop."""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.clock import NS
from rthm_core.compensators import NAMES, Compensation, started
from rthm_core.compiled import Floats
from rthm_core.errors import InputError
from rthm_core.substructure import as_built, interface

if TYPE_CHECKING:
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import ActuatorSpec, TimingSpec


def compensation(spec: Spec) -> Compensation:
    """Compensator of the spec with which the controller computes.

    Raises
    ------
    InputError
        When there is no compensator of this name.
    """
    loop, sides = spec.loop(), interface(spec)
    actuator, timing = loop.actuator, loop.timing
    way = actuator.compensator_horizon
    if way is None:
        way = timing.tau4 + sum(1.0 / pole for pole in actuator.motor_poles or ())
    return Compensation(
        code_of(actuator),
        actuator.compensator_order,
        mean_age(timing, "tau1", "td1", "td3") + 0.5 * timing.td3 + way,
        _reference_age(timing) + way,
        mean_age(timing, "tau2", "td1", "td2"),
        way,
        timing.ns("td3"),
        sides.stiffness,
        sides.damping,
    )


def code_of(actuator: ActuatorSpec) -> int:
    """Code of a compensator in `rthm_core.compensators`.

    Raises
    ------
    InputError
        When there is none of this name.
    """
    if actuator.compensator not in NAMES:
        raise InputError(
            f"actuator.compensator {actuator.compensator!r} is not available, allowed is one of "
            f"{', '.join(NAMES)}; choose one of them."
        )
    return NAMES.index(actuator.compensator)


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
    x1, force = started(how, x1, v1, force)
    return x1, force / np.array(believed.k_tot)
