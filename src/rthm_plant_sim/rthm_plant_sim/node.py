"""Node ``plant``: the simulated physical substructure with its motors and wires.

The plant moves in its own time: a sample stamped t has the values of exactly t, and a command becomes
the input of the motors exactly when its delay is over, however punctual the process is. A command that
arrives later than that becomes the input at its arrival, and is counted late. Its process may therefore be
the last of three that are due
at one instant. What is too old or beyond a limit is not executed at all (`rthm_plant_sim.guard`).
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus

from rthm_core.clock import Rank
from rthm_core.limits import kept_limits
from rthm_core.link import Inbox, Link
from rthm_core.physical import PhysicalSide
from rthm_core.physical.side import first_command
from rthm_core.ros.agenda import Agenda
from rthm_core.ros.diagnostics import ERROR, OK
from rthm_core.ros.part import PartNode
from rthm_core.ros.process import run
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec
from rthm_core.topics import COMMAND, PLANT_STATE
from rthm_plant_sim.guard import CommandGuard


class PlantNode(PartNode):
    """Publishes ``plant/state`` every Td1; acts on ``actuator/command`` over the link tau4."""

    def __init__(self) -> None:
        super().__init__("plant", leads=True, yields=1)

    def connect(self, spec: Spec) -> None:
        """Open the topics of the plant."""
        loop = spec.loop()
        self._state = self.ports.output(PLANT_STATE, (*loop.plant.dofs, *loop.actuator.names), peers=2)
        self._motor_delay = Schedule(spec).motor_delay
        # A motor faster than tau4 must have its command before the link's own instant of use.
        self._ahead = max(-self._motor_delay, 0)
        link = Link(spec, "tau4")
        link.delay_ns -= self._ahead
        between = 1.0 / loop.timing.ns("td3") + 1.0 / loop.timing.ns("td2")  # Td4 = 0: extra commands
        spacing = round(1.0 / between)
        self._commands = self.ports.input(COMMAND, loop.actuator.names, link, spacing=spacing)

    def begin(self, spec: Spec, agenda: Agenda) -> None:
        """Put the plant at rest where the spec says, with its motors."""
        self._side = PhysicalSide(spec)
        limits, td3 = kept_limits(spec, hardware=False), spec.loop().timing.ns("td3")
        self._guard = CommandGuard(limits, first_command(spec), td3)
        self._in_motor = Inbox()
        agenda.when_due(self._commands.inbox, self._receive, _command_rank(spec))
        agenda.when_due(self._in_motor, self._drive)
        agenda.every("Td1", spec.loop().timing.ns("td1"), Rank.SAMPLE, self._sample)

    def _receive(self, at: int, now: int) -> None:
        command = self._commands.take(at)
        if command is not None:
            use = at + self._ahead
            executed = self._guard.executed(command.stamp, use, np.array(command.position))
            if executed is not None:
                self._commands.tell(use, command.stamp)
                self._in_motor.push(command.stamp, use + self._motor_delay, executed)

    def _drive(self, at: int, now: int) -> None:
        command = self._in_motor.take(at)
        if command is not None:
            self._side.command(at, command[1])

    def _sample(self, at: int, now: int) -> None:
        x = self._side.sample(at)
        self._state.send(
            at,
            [*x.position.tolist(), *x.motor_position.tolist()],
            [*x.velocity.tolist(), *x.motor_velocity.tolist()],
            [*x.load.tolist(), *x.force.tolist()],
        )
        silent = self._guard.silent(at)
        if silent is not None:
            self.get_logger().error(f"no command has been executed for {silent:.3f} s: the motors hold")

    def statuses(self) -> list[DiagnosticStatus]:
        """What was not executed."""
        refused = {f"commands refused by {name}": count for name, count in self._guard.refused.items()}
        level, words = (ERROR, "refuses commands") if any(self._guard.refused.values()) else (OK, "executes")
        return [self.diagnostics.status("command guard", level, words, refused)]


def _command_rank(spec: Spec) -> Callable[[int], Rank]:
    """Rank at which the controller sends a command of this stamp: an extra one when a delay is over."""
    td3, td4 = spec.loop().timing.ns("td3"), spec.loop().timing.ns("td4")
    early = not td4 and Link(spec, "tau3").delay_ns > 0
    return lambda stamp: Rank.DELAY if early and stamp % td3 else Rank.CONTROL


Node = PlantNode
"""Node of this module."""


def main() -> int:
    """Run the node until it is asked to end."""
    return run(PlantNode)


if __name__ == "__main__":
    sys.exit(main())
