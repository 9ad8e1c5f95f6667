"""What a compensator makes of the samples that the controller has latched: a weight for each of them.

A compensator is linear in its samples, with weights that depend on their stamps alone. They are found by
asking the core's own compensator for its answer to one sample of one and all others zero.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.lifted.compiled import compiled
from rthm_core.compensation import code_of
from rthm_core.compensators import COMPENSATORS, NONE, compensated
from rthm_core.compiled import Floats, Integers
from rthm_core.controller import HISTORY, ControllerState, controller
from rthm_core.substructure import as_built

if TYPE_CHECKING:
    from rthm_analysis.lifted.cycle import Cycle
    from rthm_core.spec import Spec


class Predictor(NamedTuple):
    """A compensator in its controller.

    Attributes
    ----------
    controller : ControllerState
        The core's controller; its history is scratch.
    fixed_way : float
        Part of the way to the wire, s, that does not grow when all periods and delays do.
    """

    controller: ControllerState
    fixed_way: float


def history_of(spec: Spec) -> int:
    """How many latched samples of each signal the controller looks at; 0: it does not predict."""
    actuator = spec.loop().actuator
    return COMPENSATORS[code_of(actuator)].samples(actuator.compensator_order)


def history(state: ControllerState) -> int:
    """The same of a controller."""
    how = state.compensation
    return COMPENSATORS[how.code].samples(how.order)


def predictor(spec: Spec) -> Predictor | None:
    """Compensator of a spec; None if it has none."""
    if code_of(spec.loop().actuator) == NONE:
        return None
    state = controller(spec)
    believed = as_built(spec, "controller").loop()
    given = believed.actuator.compensator_horizon is not None
    return Predictor(state, state.compensation.way - (0.0 if given else believed.timing.tau4))


def weights(one: Predictor, cycle: Cycle, nominal_unit: float) -> Floats:
    """Weights (E, 3, H, m) of latched positions (1), velocities (s) and references (m/N, before k_tot) in the
    command of every event.

    All times go to the compensator in units of the cycle, as if these were ns, so that nothing is rounded: an
    exact change of the unit of time, under which its dampings and the weights of velocities change, too.
    """
    ns = cycle.unit * 1e9
    how, factor = one.controller.compensation, cycle.unit / nominal_unit
    way = factor * (how.way - one.fixed_way) + one.fixed_way
    in_units = how._replace(
        position_horizon=(factor * (how.position_horizon - how.way) + way) / ns,
        force_horizon=(factor * (how.force_horizon - how.way) + way) / ns,
        motion_age=factor * how.motion_age / ns,
        way=way / ns,
        period=cycle.command_period,
        damping=how.damping / ns,
    )
    state = one.controller._replace(compensation=in_units)
    out = np.zeros((cycle.time.size, 3, cycle.past.shape[2], how.stiffness.size, 2))
    _probe(state, cycle.stamps, np.flatnonzero(cycle.past[:, 0, 0] >= 0), cycle.time, out)
    out[:, 1] *= ns
    return out


@compiled
def _probe(
    controller: ControllerState, stamps: Integers, events: Integers, time: Integers, out: Floats
) -> None:
    """Position part and force part of the answer to each sample."""
    m = controller.stiffness.size
    position, force = np.empty(m), np.empty(m)
    for e in events:
        for h in range(HISTORY):
            known = h < stamps.shape[2]
            controller.state_stamp[h] = stamps[e, 0, h] if known else stamps[e, 0, 0] - 10**15 - h
            controller.force_stamp[h] = stamps[e, 1, h] if known else stamps[e, 1, 0] - 10**15 - h
        for kind in range(3):
            for h in range(stamps.shape[2]):
                controller.position[:] = 0.0
                controller.velocity[:] = 0.0
                controller.force[:] = 0.0
                for i in range(m):
                    if kind == 0:
                        controller.position[h, i] = 1.0
                    elif kind == 1:
                        controller.velocity[h, i] = 1.0
                    else:
                        controller.force[h, i] = 1.0
                compensated(controller, time[e], position, force)
                for i in range(m):
                    out[e, kind, h, i, 0] = position[i]
                    out[e, kind, h, i, 1] = force[i]
