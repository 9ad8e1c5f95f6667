"""An emulated device: the plant of a spec with its motors, behind UDP, without ROS.

    python -m rthm_plant_sim.udp.emulated rig.yaml [PORT]

It begins where the spec begins and moves in real time from then on, as a rig does: give it a spec that begins
at rest. Its limits are those of the spec.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import time
from contextlib import suppress
from types import FrameType

import numpy as np

from rthm_core.errors import InputError
from rthm_core.limits import kept_limits
from rthm_core.physical import PhysicalSide
from rthm_core.spec import Spec, spec_at
from rthm_plant_sim.udp.device import DeviceLimits, DeviceLogic, Values
from rthm_plant_sim.udp.host import LARGEST_PACKET, PORT

DEVICE_PRIORITY = 60
"""Real-time priority that is asked for: a microcontroller waits for nobody."""
LOOK = 0.01
"""Longest time between two looks at the watchdog, s."""


def limits_of(spec: Spec) -> DeviceLimits:
    """Limits of a device for a spec; InputError where one is missing."""
    kept = kept_limits(spec, hardware=True)
    assert kept.command is not None
    assert kept.rate is not None
    assert kept.start is not None
    assert kept.command_age is not None
    age, period = round(1e6 * kept.command_age), round(1e6 * spec.loop().timing.td3)
    return DeviceLimits(kept.command, kept.rate, kept.start[0], age, period)


class Emulated:
    """Plant and motors of a spec, in real time since they were made."""

    def __init__(self, spec: Spec) -> None:
        loop = spec.loop()
        self._side, self._begin = PhysicalSide(spec), time.monotonic_ns()
        n, m = len(loop.plant.dofs), len(loop.actuator.names)
        self.logic = DeviceLogic(limits_of(spec), n, m, self._sensors)

    def receive(self, packet: bytes) -> bytes | None:
        """Answer a packet, and move the motors if it commands so."""
        answer = self.logic.receive(packet, self._now_us())
        if self.logic.command is not None:
            self._side.command(self._now(), np.array(self.logic.command))
        return answer

    def watch(self) -> bool:
        """Whether the watchdog finds now that commands have ended."""
        return self.logic.watch(self._now_us())

    def _sensors(self) -> tuple[Values, Values, Values, Values]:
        found = self._side.sample(self._now())
        return found.position, found.velocity, found.motor_position, found.force  # type: ignore[return-value]

    def _now(self) -> int:
        return time.monotonic_ns() - self._begin

    def _now_us(self) -> int:
        return self._now() // 1000


def serve(spec: Spec, port: int) -> None:
    """Serve an emulated device on this host until KeyboardInterrupt."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.bind(("127.0.0.1", port))
        ear.settimeout(LOOK)
        with suppress(PermissionError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(DEVICE_PRIORITY))
        device = Emulated(spec)
        device.receive(b"")
        print(f"emulated device at 127.0.0.1:{ear.getsockname()[1]}", flush=True)
        while True:
            try:
                packet, sender = ear.recvfrom(LARGEST_PACKET)
            except TimeoutError:
                packet = b""
            if device.watch():
                print("no fresh command: the motors hold", flush=True)
            answer = device.receive(packet) if packet else None
            if answer is not None:
                ear.sendto(answer, sender)


def main() -> int:
    """Run until SIGINT or SIGTERM; exit status 2 with one sentence for bad input."""
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        serve(spec_at(sys.argv[1] if sys.argv[1:] else "paper"), int(sys.argv[2]) if sys.argv[2:] else PORT)
    except (InputError, OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 0
    return 0


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
