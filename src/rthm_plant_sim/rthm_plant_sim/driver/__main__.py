"""A class of a Python file as a driver.

usage: python -m rthm_plant_sim.driver SPEC FILE.py:CLASS [--dead-time S]
"""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

from rthm_core.errors import InputError
from rthm_plant_sim.driver import Device, drive
from rthm_plant_sim.driver.arguments import parser, status_of, told


def device_of(place: str) -> Device:
    """Make the device that ``FILE.py:CLASS`` names; InputError where there is none."""
    file, _, name = place.rpartition(":")
    if not file or not Path(file).is_file():
        raise InputError(
            f"The device is {place!r}, but must be FILE.py:CLASS of an existing file; correct it."
        )
    found = runpy.run_path(file)
    if not callable(found.get(name)):
        raise InputError(f"{file} has no class {name}; name one that it has.")
    made = found[name]()
    missing = [what for what in ("read", "command") if not callable(getattr(made, what, None))]
    if missing:
        raise InputError(f"{name} of {file} has no {' and no '.join(missing)}; a device needs both.")
    device: Device = made
    return device


def main() -> int:
    """Drive until SIGINT or SIGTERM."""
    arguments = parser("A class of a Python file as a driver.")
    arguments.add_argument("device", metavar="FILE.py:CLASS", help="a class with read() and command(u)")
    given = told(arguments, sys.argv[1:])
    return status_of(lambda: drive(device_of(given.device), given.spec, given.dead_time))


if __name__ == "__main__":
    sys.exit(main())
