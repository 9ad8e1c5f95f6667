"""Command lines of drivers: what is theirs, and what is for ROS."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable

from rthm_core.errors import InputError

ROS = "--ros-args"


def parser(description: str) -> ArgumentParser:
    """Parser with what every driver is told."""
    made = ArgumentParser(description=description, epilog="What follows --ros-args is for ROS.")
    made.add_argument("spec", help="a spec file, or the name of a shipped one")
    made.add_argument(
        "--dead-time", type=float, default=0.0, metavar="S", help="from a command to its effect, s"
    )
    return made


def told(parser: ArgumentParser, arguments: list[str]) -> Namespace:
    """Read the part of a command line that is not for ROS."""
    own = arguments[: arguments.index(ROS)] if ROS in arguments else arguments
    return parser.parse_args(own)


def status_of(drive: Callable[[], int]) -> int:
    """Exit status of a driver; 2 and one sentence where it cannot begin with what it was given."""
    try:
        return drive()
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
