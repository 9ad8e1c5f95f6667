"""Base of a driver for real hardware: whoever can read sensors and command motors has a driver.

    class Rig:
        def read(self):
            return position, velocity, motor, force

        def command(self, u): ...

    sys.exit(drive(Rig(), "rig.yaml"))

Clock grid, stamps, tau4, watchdog, limits and arming are the base's (docs/driver.md).
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rthm_core.errors import InputError
from rthm_plant_sim.driver.device import Device, Reading

if TYPE_CHECKING:
    from pathlib import Path

    from rthm_core.spec import Spec

__all__ = ["Device", "Reading", "drive"]


def drive(device: Device, spec: Spec | Path | str, dead_time: float = 0.0) -> int:
    """Run a device as the plant of tests until SIGINT or SIGTERM, whatever tests come and go.

    Parameters
    ----------
    device
        What reads the sensors and commands the motors.
    spec
        A spec, its file, or the name of a shipped one; it needs the limits of a real machine.
    dead_time
        Time from a call of `device.command` to its effect, s; a command waits so much less than tau4.

    Returns
    -------
    int
        Exit status: 0, or 2 with one sentence on standard error when spec and device do not fit.
    """
    from rthm_core.ros.process import run  # ROS is imported only by who drives
    from rthm_core.spec import spec_at
    from rthm_plant_sim.driver.node import DriverNode

    try:
        return run(lambda: DriverNode(device, spec_at(spec), dead_time))
    except InputError as error:  # of a first reading
        print(error, file=sys.stderr)
        return 2
