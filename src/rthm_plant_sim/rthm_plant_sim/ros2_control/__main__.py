"""A rig under ros2_control as a driver.

usage: python -m rthm_plant_sim.ros2_control SPEC [--joints x1=table,a1=piston] [--order piston]
           [--states /joint_states] [--commands /forward_position_controller/commands] [--dead-time S]
"""

from __future__ import annotations

import sys
from argparse import Namespace

from rthm_core.spec import spec_at
from rthm_plant_sim.driver.arguments import parser, status_of, told
from rthm_plant_sim.ros2_control.joints import Joints

STATES, COMMANDS = "/joint_states", "/forward_position_controller/commands"


def main() -> int:
    """Drive until SIGINT or SIGTERM."""
    arguments = parser("A rig under ros2_control as a driver.")
    arguments.add_argument(
        "--joints", default="", metavar="NAME=JOINT,...", help="joints of the spec's names"
    )
    arguments.add_argument(
        "--order", default="", metavar="JOINT,...", help="joints of the controller, in order"
    )
    arguments.add_argument("--states", default=STATES, metavar="TOPIC", help=f"by default {STATES}")
    arguments.add_argument("--commands", default=COMMANDS, metavar="TOPIC", help=f"by default {COMMANDS}")
    given = told(arguments, sys.argv[1:])
    return status_of(lambda: _drive(given))


def _drive(given: Namespace) -> int:
    from rthm_core.ros.process import run
    from rthm_plant_sim.ros2_control.node import BridgeNode

    spec = spec_at(given.spec)
    joints = Joints(spec, given.joints, [name.strip() for name in given.order.split(",") if name.strip()])
    return run(lambda: BridgeNode(spec, joints, given.states, given.commands, given.dead_time))


if __name__ == "__main__":
    sys.exit(main())
