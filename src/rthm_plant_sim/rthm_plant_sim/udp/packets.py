"""Packets between a driver and a device: docs/udp.md has them as a table, examples/udp_device.c in C99.

All numbers are little-endian. A request of the host has a command or none; a state of the device answers it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from struct import Struct, pack_into, unpack_from
from typing import NamedTuple

MAGIC, VERSION = b"RTHM", 1
REQUEST, STATE = 1, 2
COMMANDS = 1
"""Flag of a request: it has a command."""
ARMED, OLD, FAR, BAD = 1, 2, 4, 8
"""Flags of a state: motors are under command; the command that it answers was too old, too far, or bad."""
MOST_DOFS = 16
"""Most dofs, and most actuators."""
MODULUS = 2**32

_HEAD = Struct("<4sBBBBIIIII4x")
"""Magic, version, kind, dofs, actuators, session, number, echo, time, flags."""
HEAD = _HEAD.size


class Request(NamedTuple):
    """What the host sends.

    Attributes
    ----------
    dofs
        Number n of dofs of the plant.
    session
        Number of the connection, drawn by the host.
    number
        Of this request, from 1.
    echo, time
        Number and device's time of the newest state that the host has of this session; 0: none yet.
    commanded
        Whether the command counts.
    command
        Positions (m,) of the motors, m.
    """

    dofs: int
    session: int
    number: int
    echo: int
    time: int
    commanded: bool
    command: Sequence[float]

    def packet(self) -> bytes:
        """Bytes on the wire."""
        m = len(self.command)
        whose = (self.session, self.number, self.echo, self.time, COMMANDS if self.commanded else 0)
        return _HEAD.pack(MAGIC, VERSION, REQUEST, self.dofs, m, *whose) + _doubles(self.command)


class State(NamedTuple):
    """What the device answers.

    Attributes
    ----------
    session, echo
        Those of the request that is answered: `echo` is its number.
    number
        Of this state, from 1.
    time
        When it was sent by the device's clock, us, of 32 bits.
    flags
        Sum of `ARMED`, `OLD`, `FAR`, `BAD`.
    position, velocity
        Of the n dofs, m and m/s.
    motor, force
        Of the m actuators, m and N.
    """

    session: int
    number: int
    echo: int
    time: int
    flags: int
    position: Sequence[float]
    velocity: Sequence[float]
    motor: Sequence[float]
    force: Sequence[float]

    def packet(self) -> bytes:
        """Bytes on the wire."""
        n, m = len(self.position), len(self.motor)
        whose = (self.session, self.number, self.echo, self.time, self.flags)
        values = (*self.position, *self.velocity, *self.motor, *self.force)
        return _HEAD.pack(MAGIC, VERSION, STATE, n, m, *whose) + _doubles(values)


def read_request(data: bytes) -> Request:
    """Read a request; ValueError, with what is wrong, where it is none."""
    n, m, session, number, echo, time, flags = _head(data, REQUEST, lambda n, m: m)
    command = unpack_from(f"<{m}d", data, HEAD)
    return Request(n, session, number, echo, time, bool(flags & COMMANDS), command)


def read_state(data: bytes) -> State:
    """Read a state; ValueError, with what is wrong, where it is none."""
    n, m, session, number, echo, time, flags = _head(data, STATE, lambda n, m: 2 * n + 2 * m)
    values = unpack_from(f"<{2 * n + 2 * m}d", data, HEAD)
    position, velocity, motor, force = (
        values[a:b] for a, b in ((0, n), (n, 2 * n), (2 * n, 2 * n + m), (2 * n + m, 2 * n + 2 * m))
    )
    return State(session, number, echo, time, flags, position, velocity, motor, force)


def ahead(number: int, other: int) -> int:
    """How far a number of 32 bits, which wraps around, is ahead of another one; negative: behind."""
    return (number - other + MODULUS // 2) % MODULUS - MODULUS // 2


def _head(data: bytes, kind: int, doubles: Callable[[int, int], int]) -> tuple[int, ...]:
    """Dofs, actuators, session, number, echo, time and flags."""
    if len(data) < HEAD or data[:4] != MAGIC:
        raise ValueError("is not a packet of this protocol")
    _, version, kind_, n, m, *whose = _HEAD.unpack_from(data)
    if version != VERSION:
        raise ValueError(f"has version {version} of the protocol, and this program has {VERSION}")
    if kind_ != kind or not (1 <= n <= MOST_DOFS and 1 <= m <= MOST_DOFS):
        raise ValueError(f"is of kind {kind_} with {n} dofs and {m} actuators")
    if len(data) != HEAD + 8 * doubles(n, m):
        raise ValueError(f"has {len(data)} bytes for {n} dofs and {m} actuators")
    return n, m, *whose


def _doubles(values: Sequence[float]) -> bytes:
    data = bytearray(8 * len(values))
    pack_into(f"<{len(values)}d", data, 0, *values)
    return bytes(data)
