"""Whether this host has a network over which others can be found."""

from __future__ import annotations

import time
from collections.abc import Callable

from rthm_core.errors import InputError
from rthm_core.ros.sockets import addresses

NETWORK_UP_WITHIN = 10.0
"""How long a network may take to come up, s: the host or its cable may be a second old."""


def wait_for_one(
    say: Callable[[str], None],
    seconds: float = NETWORK_UP_WITHIN,
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
                "Only the loopback interface of this host is up, so no other host can be found; bring one up,"
                " or leave --network and --peers out."
            )
        if not waited:
            say("waiting for a network of this host to come up")
        waited = True
        time.sleep(0.05)
