"""A device behind UDP as a driver.

usage: python -m rthm_plant_sim.udp SPEC HOST[:PORT] [--dead-time S]
"""

from __future__ import annotations

import sys

from rthm_core.spec import spec_at
from rthm_plant_sim.driver import drive
from rthm_plant_sim.driver.arguments import parser, status_of, told
from rthm_plant_sim.udp.host import UdpDevice


def main() -> int:
    """Drive until SIGINT or SIGTERM."""
    arguments = parser("A device behind UDP as a driver.")
    arguments.add_argument("address", metavar="HOST[:PORT]", help="where the device listens")
    given = told(arguments, sys.argv[1:])
    return status_of(lambda: _drive(given.spec, given.address, given.dead_time))


def _drive(place: str, address: str, dead_time: float) -> int:
    spec = spec_at(place)
    return drive(UdpDevice(address, spec), spec, dead_time)


if __name__ == "__main__":
    sys.exit(main())
