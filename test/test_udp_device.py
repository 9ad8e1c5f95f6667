"""The C example does what the emulated device does, packet by packet."""

from __future__ import annotations

import ctypes
import shutil
import struct
import subprocess
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rthm_plant_sim.udp.device import DeviceLimits, DeviceLogic
from rthm_plant_sim.udp.packets import MODULUS, Request

EXAMPLES = Path(__file__).parents[1] / "examples"
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler (cc, gcc, clang) is on the path")
FLAGS = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2"]
LIMITS = DeviceLimits(command=1.0, rate=5.0, start=0.01, command_age=50_000, period=4000)


class Sensors(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double * 1) for name in ("position", "velocity", "motor", "force")]


READ = ctypes.CFUNCTYPE(None, ctypes.POINTER(Sensors))


class Limits(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("command", "rate", "start")] + [
        (name, ctypes.c_uint32) for name in ("command_age", "period")
    ]


class Device(ctypes.Structure):
    _fields_ = [
        ("limits", Limits),
        ("read", READ),
        ("armed", ctypes.c_bool),
        ("command", ctypes.c_double * 1),
        *((name, ctypes.c_uint32) for name in ("session", "heard", "number", "fresh")),
    ]


class Pair:
    """The device in C and the one in Python, with the same motor."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self.library, self.motor = library, 0.4
        self.read = READ(self._read)
        given = (LIMITS.command, LIMITS.rate, LIMITS.start, LIMITS.command_age, LIMITS.period)
        self.in_c = Device(limits=Limits(*given), read=self.read)
        self.in_python = DeviceLogic(LIMITS, 1, 1, lambda: ([0.3], [-0.1], [self.motor], [4.0]))

    def receive(self, packet: bytes, now: int) -> bytes | None:
        """Answer of both to a packet, which must be the same."""
        answer = ctypes.create_string_buffer(64)
        size = self.library.device_receive(ctypes.byref(self.in_c), packet, len(packet), now, answer)
        expected = self.in_python.receive(packet, now)
        assert (answer.raw[:size] or None) == expected
        assert self.in_c.armed == self.in_python.armed
        if self.in_python.command is not None:
            assert self.in_c.command[0] == self.in_python.command[0]
            self.motor = self.in_python.command[0]
        return expected

    def watch(self, now: int) -> None:
        """Look at both watchdogs."""
        found = self.library.device_watch(ctypes.byref(self.in_c), now)
        assert bool(found & 1) == self.in_python.watch(now)

    def _read(self, sensors: ctypes._Pointer[Sensors]) -> None:
        told = sensors.contents
        told.position[0], told.velocity[0], told.motor[0], told.force[0] = 0.3, -0.1, self.motor, 4.0


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    file = tmp_path_factory.mktemp("c") / "udp_device.so"
    assert COMPILER is not None
    command = [COMPILER, *FLAGS, "-shared", "-fPIC", "-o", file, EXAMPLES / "udp_device.c", "-lm"]
    subprocess.run(command, check=True)
    loaded = ctypes.CDLL(str(file))
    loaded.device_receive.restype = ctypes.c_size_t
    loaded.device_receive.argtypes = [
        ctypes.POINTER(Device), ctypes.c_char_p, ctypes.c_size_t, ctypes.c_uint32, ctypes.c_char_p
    ]  # fmt: skip
    loaded.device_watch.argtypes = [ctypes.POINTER(Device), ctypes.c_uint32]
    loaded.device_watch.restype = ctypes.c_bool
    return loaded


STEPS = st.lists(
    st.tuples(
        st.sampled_from([500, 1200, 4000, 30_000, 60_000]),  # us that pass
        st.sampled_from(["ask", "command", "far", "nan", "again", "old", "thief", "noise", "watch"]),
        st.floats(-0.012, 0.012),
    ),
    min_size=20,
    max_size=60,
)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(STEPS, st.integers(0, MODULUS - 1))
def test_both_answer_every_packet_with_the_same_bytes(
    library: ctypes.CDLL, steps: list[tuple[int, str, float]], begin: int
) -> None:
    pair, now, number, time, packet = Pair(library), begin, MODULUS - 10, 0, b""
    for passed, what, away in steps:
        now = (now + passed) % MODULUS
        if what == "watch":
            pair.watch(now)
            continue
        number = (number + 1) % MODULUS
        session = 9 if what == "thief" else 7
        value = {"far": pair.motor + 0.3, "nan": float("nan")}.get(what, pair.motor + away)
        echoed = (time - 70_000) % MODULUS if what == "old" else time
        if what == "noise":
            packet = struct.pack("<d", away) + packet[4:]
        elif what != "again":
            packet = Request(1, session, number, 0, echoed, what not in ("ask", "thief"), [value]).packet()
        answer = pair.receive(packet, now)
        if answer is not None and session == 7:
            time = struct.unpack_from("<I", answer, 20)[0]


def test_the_protocol_part_calls_no_operating_system() -> None:
    code = (EXAMPLES / "udp_device.c").read_text()
    included = {line.split()[1] for line in code.splitlines() if line.startswith("#include")}
    assert included == {'"udp_device.h"', "<math.h>", "<string.h>"}
