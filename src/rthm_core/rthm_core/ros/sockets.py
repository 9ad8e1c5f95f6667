"""Sockets of this process, as the kernel lists them, and whose packets they take.

A filter is a program in classic BPF that the kernel runs for each packet; a process may give one to its own
sockets without any privilege.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import socket
from collections.abc import Iterable, Iterator
from ipaddress import IPv4Address
from pathlib import Path
from struct import Struct, pack, unpack_from
from typing import NamedTuple

_TABLES = ("udp", "udp6", "tcp", "tcp6")
_LISTENING = 0x0A
_GET_FLAGS, _GET_ADDRESS, _RUNNING, _LOOPBACK = 0x8913, 0x8915, 0x40, 0x8
_ATTACH_FILTER = 26
_LOAD, _AND, _EQUAL, _RETURN = 0x20, 0x54, 0x15, 0x06
_SOURCE = 0xFFF00000 + 12  # offset of the source in the header of IPv4, counted from SKF_NET_OFF
_STEP = Struct("=HBBI")


class Socket(NamedTuple):
    """A socket that packets can come in by.

    Attributes
    ----------
    descriptor, kind
        File descriptor, and the kernel's table: ``udp``, ``udp6``, ``tcp`` or ``tcp6``.
    address
        Address that it is bound to, in hexadecimal digits as in the table.
    port
        Port that it is bound to.
    """

    descriptor: int
    kind: str
    address: str
    port: int

    @property
    def loopback(self) -> bool:
        """Whether it is bound to the loopback interface, to which nothing from outside is passed."""
        if self.kind.endswith("6"):
            return self.address == "0" * 24 + "01000000"
        return self.address.endswith("7F")


def own() -> list[Socket]:
    """Sockets of this process."""
    descriptors = dict(_descriptors())
    found = []
    for kind in _TABLES:
        table = Path("/proc/self/net") / kind
        for line in table.read_text().splitlines()[1:] if table.exists() else []:
            words = line.split()
            descriptor = descriptors.get(f"socket:[{words[9]}]")
            if descriptor is not None and (kind.startswith("udp") or int(words[3], 16) == _LISTENING):
                address, port = words[1].split(":")
                found.append(Socket(descriptor, kind, address, int(port, 16)))
    return found


def _descriptors() -> Iterator[tuple[str, int]]:
    for name in os.listdir("/proc/self/fd"):
        try:
            yield os.readlink(f"/proc/self/fd/{name}"), int(name)
        except OSError:  # the listing itself, closed by now
            continue


def addresses() -> list[str]:
    """IPv4 addresses of the interfaces that run now, but for loopback."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        names = [name for _, name in socket.if_nameindex()]
        found = (_address(any_socket.fileno(), name) for name in names)
        return [address for address in found if address is not None]


def _address(descriptor: int, name: str) -> str | None:
    asked = pack("40s", name.encode())
    try:
        flags = unpack_from("H", fcntl.ioctl(descriptor, _GET_FLAGS, asked), 16)[0]
        if flags & _LOOPBACK or not flags & _RUNNING:
            return None
        return socket.inet_ntoa(fcntl.ioctl(descriptor, _GET_ADDRESS, asked)[20:24])
    except OSError:  # without an address, or gone meanwhile
        return None


def only_from(sources: Iterable[IPv4Address]) -> bytes:
    """Filter that passes packets of these hosts, and of the loopback interface."""
    named = sorted(set(sources))
    accept = len(named) + 4
    steps = [(_LOAD, 0, 0, _SOURCE)]
    steps += [(_EQUAL, accept - at, 0, int(address)) for at, address in enumerate(named, start=2)]
    steps += [
        (_AND, 0, 0, 0xFF000000),
        (_EQUAL, 1, 0, 127 << 24),
        (_RETURN, 0, 0, 0),
        (_RETURN, 0, 0, 2**32 - 1),
    ]
    return b"".join(_STEP.pack(*step) for step in steps)


def attach(descriptor: int, program: bytes) -> None:
    """Give a filter to a socket; OSError where the kernel does not take it."""
    steps = ctypes.create_string_buffer(program, len(program))
    head = pack("HP", len(program) // _STEP.size, ctypes.addressof(steps))
    with socket.socket(fileno=os.dup(descriptor)) as one:
        one.setsockopt(socket.SOL_SOCKET, _ATTACH_FILTER, head)
