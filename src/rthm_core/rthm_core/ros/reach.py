"""Whose packets a node takes: enforced on the sockets that it has got, and looked at rather than believed.

A profile of the middleware that cannot be read is only logged there, and leaves everything open. So a process
looks at its sockets once its node exists. What ``RTHM_REACH`` may say:

- ``host``: every socket must be bound to the loopback interface; else the process ends.
- ``peers``: sockets for samples and services take packets from the hosts of ``ROS_STATIC_PEERS`` and from
  this one; all others are dropped by the kernel, before the middleware sees them. Announcements pass, so that
  a host that nobody named is seen when it publishes what belongs to a test.
- anything else: open.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Iterable, Mapping
from ipaddress import IPv4Address

from rthm_core.errors import InputError
from rthm_core.ros import sockets

VARIABLE, PEERS = "RTHM_REACH", "ROS_STATIC_PEERS"
HOST, NAMED, OPEN = "host", "peers", "open"


def enforce(domain: int, environment: Mapping[str, str] = os.environ) -> None:
    """Keep others than ``RTHM_REACH`` says from this process.

    Parameters
    ----------
    domain
        ROS domain of its nodes: the ports of announcements follow from it.

    Raises
    ------
    InputError
        When a socket is open to other hosts and must not be, or takes no filter.
    """
    reach = environment.get(VARIABLE)
    if reach == HOST:
        refuse_open(sockets.own())
    elif reach == NAMED:
        _filter(domain, addresses_of(environment.get(PEERS, "").split(";")))


def refuse_open(found: Iterable[sockets.Socket]) -> None:
    """Refuse sockets that are not bound to the loopback interface, with an InputError."""
    open_ = sorted({one.port for one in found if not one.loopback})
    if open_:
        raise InputError(
            f"The middleware listens to other hosts at port {', '.join(map(str, open_))}, but must not"
            " without --network: its profile is not in force; use rmw_fastrtps_cpp, or give --network."
        )


def announces(port: int, domain: int) -> bool:
    """Whether a port of a domain is for announcements only (RTPS 2.2, section 9.6.1.1)."""
    offset = port - 7400 - 250 * domain
    return offset == 0 or (10 <= offset < 250 and offset % 2 == 0)


def addresses_of(hosts: Iterable[str]) -> list[IPv4Address]:
    """IPv4 addresses of hosts given by name or address; InputError where one has none."""
    found: set[IPv4Address] = set()
    for host in filter(None, hosts):
        try:
            entries = socket.getaddrinfo(host, None, socket.AF_INET)
        except OSError as error:
            raise InputError(
                f"The peer {host!r} has no IPv4 address ({error.strerror}); name another one."
            ) from error
        found |= {IPv4Address(entry[4][0]) for entry in entries}
    return sorted(found)


def _filter(domain: int, peers: Iterable[IPv4Address]) -> None:
    program = sockets.only_from([*peers, *map(IPv4Address, sockets.addresses())])
    try:
        for one in sockets.own():
            if not one.loopback and not announces(one.port, domain):
                sockets.attach(one.descriptor, program)
    except OSError as error:
        raise InputError(
            f"The kernel takes no filter for packets of other hosts ({error.strerror}), but with --peers"
            " only those of the peers may come in; use --network on a network of your own."
        ) from error
