"""Whether this host has a network over which others can be found."""

from __future__ import annotations

import fcntl
import socket
import struct
import time
from collections.abc import Callable

from rthm_core.errors import InputError

GET_FLAGS, GET_ADDRESS = 0x8913, 0x8915
LOOPBACK, RUNNING = 0x8, 0x40
PATIENCE = 10.0
"""How long a network may take to come up, s: the host or its cable may be a second old."""


def addresses() -> list[str]:
    """IPv4 addresses of the interfaces that run now, without loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        names = [name for _, name in socket.if_nameindex()]
        return [found for name in names if (found := _address(any_socket.fileno(), name)) is not None]


def _address(descriptor: int, name: str) -> str | None:
    asked = struct.pack("40s", name.encode())
    try:
        flags = struct.unpack_from("H", fcntl.ioctl(descriptor, GET_FLAGS, asked), 16)[0]
        if flags & LOOPBACK or not flags & RUNNING:
            return None
        return socket.inet_ntoa(fcntl.ioctl(descriptor, GET_ADDRESS, asked)[20:24])
    except OSError:  # without an address, or gone meanwhile
        return None


def wait_for_one(
    say: Callable[[str], None],
    seconds: float = PATIENCE,
    found: Callable[[], list[str]] = addresses,
) -> None:
    """Wait until an interface to other hosts runs.

    A node takes the addresses that its host has when it starts: one that is started earlier announces itself
    on the loopback interface, and is never found by another host.

    Raises
    ------
    InputError
        If none runs after `seconds`.
    """
    deadline = time.monotonic() + seconds
    waited = False
    while not found():
        if time.monotonic() > deadline:
            raise InputError(
                "No network of this host is up but loopback, so no other host can be found; bring one up,"
                " or leave --network and --peers out."
            )
        if not waited:
            say("waiting for a network of this host to come up")
        waited = True
        time.sleep(0.05)
