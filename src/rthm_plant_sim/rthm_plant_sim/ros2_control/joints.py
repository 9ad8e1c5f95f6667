"""Which joint is which dof or motor of the spec, and in which order a controller wants its commands."""

from __future__ import annotations

from collections.abc import Sequence

from rthm_core.errors import InputError
from rthm_core.ros.messages import JointSample
from rthm_core.spec import Spec
from rthm_plant_sim.driver.device import Reading


class Joints:
    """Names of a rig beside those of a spec.

    Parameters
    ----------
    spec
        A complete loop.
    named
        ``x1=table,a1=piston``: the joint of a dof or of an actuator; one that is left out has the same name.
    order
        Joints of the command controller, in its order; by default the motors in the order of the spec.

    Attributes
    ----------
    names
        Joints of the dofs, then of the actuators, in the order of the spec.
    order
        Joints of the controller.

    Raises
    ------
    InputError
        When a name is not of the spec, a joint stands for two, or the controller has others than motors.
    """

    def __init__(self, spec: Spec, named: str = "", order: Sequence[str] = ()) -> None:
        loop = spec.loop()
        own, self._dofs = (*loop.plant.dofs, *loop.actuator.names), len(loop.plant.dofs)
        given = _pairs(named, own)
        self.names = tuple(given.get(name, name) for name in own)
        twice = sorted({name for name in self.names if self.names.count(name) > 1})
        if twice:
            raise InputError(f"The joint {twice[0]} stands for two names of the spec; name two joints.")
        motors = self.names[self._dofs :]
        self.order = tuple(order) or motors
        if sorted(self.order) != sorted(motors):
            raise InputError(
                f"The controller commands {', '.join(self.order)}, but the motors of the test are"
                f" {', '.join(motors)}; give the controller these joints, in any order."
            )
        self._places = [motors.index(joint) for joint in self.order]

    def reading(self, state: JointSample) -> Reading:
        """Reading of a joint state in the order of `names`; the effort of a motor's joint is its force."""
        n = self._dofs
        return Reading(
            state.position[:n],
            state.velocity[:n],
            state.position[n:],
            state.effort[n:],
            motor_velocity=state.velocity[n:],
            stamp=state.stamp,
        )

    def ordered(self, command: Sequence[float]) -> list[float]:
        """Commands of the motors in the order of the controller."""
        return [float(command[place]) for place in self._places]


def _pairs(named: str, own: Sequence[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for pair in filter(None, (part.strip() for part in named.split(","))):
        name, _, joint = (word.strip() for word in pair.partition("="))
        if not joint or name not in own or name in found:
            raise InputError(
                f"{pair!r} names no joint, but must be NAME=JOINT with a name of the spec, each once:"
                f" {', '.join(own)}; correct it."
            )
        found[name] = joint
    return found
