"""Node ``numerical``: the numerical substructure.

On every tick of Td2 it takes the newest state of the plant whose delay tau2 is over, and publishes its
own state and the force reference F_d, both of exactly this tick.
"""

from __future__ import annotations

import sys

import numpy as np

from rthm_core.clock import Rank
from rthm_core.link import Link
from rthm_core.numerical import NumericalSide
from rthm_core.ros.agenda import Agenda
from rthm_core.ros.part import PartNode
from rthm_core.ros.process import run
from rthm_core.spec import Spec
from rthm_core.topics import FORCE_REFERENCE, NUMERICAL_STATE, PLANT_STATE


class NumericalNode(PartNode):
    """Publishes ``numerical/state`` and ``numerical/force_reference``; sees the plant over tau2."""

    def __init__(self) -> None:
        super().__init__("numerical")

    def connect(self, spec: Spec) -> None:
        """Open the topics of the numerical substructure."""
        loop = spec.loop()
        self._state = self.ports.output(NUMERICAL_STATE, loop.numerical.dofs)
        self._reference = self.ports.output(FORCE_REFERENCE, loop.actuator.names, fields=["effort"], peers=1)
        td1 = loop.timing.ns("td1")
        self._plant = self.ports.input(PLANT_STATE, loop.interface.plant_dof, Link(spec, "tau2"), period=td1)

    def begin(self, spec: Spec, agenda: Agenda) -> None:
        """Put the numerical substructure where the spec says."""
        self._side = NumericalSide(spec)
        self._used: int | None = None
        agenda.every("Td2", spec.loop().timing.ns("td2"), Rank.NUMERICAL, self._update)

    def _update(self, at: int, now: int) -> None:
        side = self._side
        side.advance(at)
        z1 = self._plant.take(at)
        if z1 is not None:
            side.latch(np.array(z1.position), np.array(z1.velocity))
            self._used = z1.stamp
        self._reference.send(at, side.force_reference())
        self._state.send(at, side.position, side.velocity, side.load)
        if self._used is not None:
            self._plant.tell(now, self._used)


Node = NumericalNode
"""Node of this module."""


def main() -> int:
    """Run the node until it is asked to end."""
    return run(NumericalNode)


if __name__ == "__main__":
    sys.exit(main())
