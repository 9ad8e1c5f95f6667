"""Mean delays of a loop: what a planned test, which nobody has recorded yet, will feel of its links."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from rthm_core.compensation import compensation
from rthm_core.compensators import NONE
from rthm_core.spec.effect import sizes
from rthm_core.substructure import as_built
from rthm_core.topics import LINKS

if TYPE_CHECKING:
    from rthm_core.spec import Spec

MOTOR_TIMES = ("delay", "time_constant")
"""Parameters of effects of a motor that make it late."""


class Delays(NamedTuple):
    """Mean delays, s, holds included.

    Attributes
    ----------
    position : float
        Of x1 from the plant to the motor's end of the wire.
    reference : float
        Of F_d from the numerical substructure to there.
    seen : float
        Of z1 within a force reference, at its tick.
    held : float
        Of z1 as the numerical substructure holds it.
    """

    position: float
    reference: float
    seen: float
    held: float


def delays_of(spec: Spec) -> Delays:
    """Mean delays of a loop with its effects; what a compensator makes up for is taken out."""
    how, timing = compensation(as_built(spec, "controller")), spec.loop().timing
    late = {name: _extra(spec, f"link.{name}") for name in LINKS}
    way = timing.tau4 + late["tau4"] + _motor(spec)
    position, reference, seen = way + late["tau1"], way + late["tau3"], late["tau2"]
    if how.code == NONE:
        position, reference = (
            position + how.position_horizon - how.way,
            reference + how.force_horizon - how.way,
        )
        seen += how.motion_age
    else:
        position, reference = max(position - how.way, 0.0), max(reference - how.way, 0.0)
    return Delays(position, reference, seen, how.motion_age + late["tau2"] + 0.5 * timing.td2)


def _motor(spec: Spec) -> float:
    """Mean delay of a motor behind tau4, s."""
    poles = spec.loop().actuator.motor_poles or ()
    times = (e.parameters.get(name, 0.0) for e in spec.effects if e.block == "motor" for name in MOTOR_TIMES)
    return sum(1.0 / pole for pole in poles) + sum(float(one) for one in times)


def _extra(spec: Spec, block: str) -> float:
    """Extra delay of a link by effects of the spec, s."""
    return sum(sizes(spec.effects, block, "delay"))
