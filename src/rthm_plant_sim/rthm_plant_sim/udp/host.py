"""The host's side: a device behind UDP as the device of a driver."""

from __future__ import annotations

import secrets
import socket
import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.spec import Spec
from rthm_plant_sim.driver.device import Reading
from rthm_plant_sim.udp.packets import ARMED, BAD, FAR, MODULUS, OLD, Request, State, read_state

PORT = 9750
"""Where a device listens, by default."""
PATIENCE = NS // 100
"""Longest wait for an answer, ns: later than that, nobody knows when the sensors were read."""
LARGEST_PACKET = 2048
WHY = {OLD: "too old", FAR: "too far from the motors to begin there", BAD: "not finite or too large"}


class UdpDevice:
    """A device at an address, read by asking it.

    Parameters
    ----------
    address
        ``HOST`` or ``HOST:PORT``.
    spec
        A complete loop: numbers of dofs and actuators.

    Attributes
    ----------
    unanswered
        How many requests had no answer in time.
    flags
        Of the states since the last reading but one: refusals of any of them.

    Raises
    ------
    InputError
        When the address is none.
    """

    def __init__(self, address: str, spec: Spec) -> None:
        loop = spec.loop()
        self._dofs, self._actuators = len(loop.plant.dofs), len(loop.actuator.names)
        self._address = _address(address)
        self._socket: socket.socket | None = None
        self._session = secrets.randbelow(MODULUS - 1) + 1
        self._number = self._echo = self._time = self._refused = 0
        self.unanswered = self.flags = 0

    def read(self) -> Reading | None:
        """Ask for a state; None where no answer comes in time. OSError where the network refuses."""
        state = self._answer_to(self._send(None))
        if state is None:
            self.unanswered += 1
            return None
        self.flags, self._refused = state.flags | self._refused, 0
        return Reading(state.position, state.velocity, state.motor, state.force)

    def command(self, u: NDArray[np.float64]) -> None:
        """Send a command; the answer is looked at with the next reading."""
        if self._echo:
            self._send(u.tolist())

    def close(self) -> None:
        """Let the socket go."""
        if self._socket is not None:
            self._socket.close()

    def words(self) -> str:
        """Say what the device says."""
        refused = [why for flag, why in WHY.items() if self.flags & flag]
        state = "under command" if self.flags & ARMED else "holds"
        return f"{state}; the command is {' and '.join(refused)}" if refused else state

    def _send(self, command: Sequence[float] | None) -> int:
        """Send a request with a command, or with none; return its number."""
        if self._socket is None:
            self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._socket.connect(self._address)
        self._number = self._number % (MODULUS - 1) + 1
        values = [0.0] * self._actuators if command is None else command
        head = (self._dofs, self._session, self._number, self._echo, self._time, command is not None)
        self._socket.send(Request(*head, values).packet())
        return self._number

    def _answer_to(self, number: int) -> State | None:
        """State that answers a request; answers to earlier ones were made earlier, and are passed over."""
        assert self._socket is not None
        end = time.monotonic_ns() + PATIENCE
        while (left := end - time.monotonic_ns()) > 0:
            self._socket.settimeout(left / NS)
            try:
                state = read_state(self._socket.recv(LARGEST_PACKET))
            except (TimeoutError, BlockingIOError):
                return None
            except ValueError:  # of somebody else's, or of another version
                continue
            if state.session == self._session:
                self._echo, self._time = state.number, state.time
                self._refused |= state.flags & ~ARMED
                if state.echo == number:
                    return state
        return None


def _address(text: str) -> tuple[str, int]:
    host, _, port = text.partition(":")
    if not host or (port and not (port.isascii() and port.isdigit() and 0 < int(port) < 2**16)):
        raise InputError(f"The device is at {text!r}, but must be at HOST or HOST:PORT; correct it.")
    return host, int(port or PORT)
