"""Packets of a device behind UDP, and what the device executes."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_plant_sim.udp import packets
from rthm_plant_sim.udp.device import DeviceLimits, DeviceLogic
from rthm_plant_sim.udp.packets import ARMED, BAD, FAR, OLD, Request, State, read_request, read_state

LIMITS = DeviceLimits(command=1.0, rate=5.0, start=0.01, command_age=50_000, period=4000)
NUMBERS = st.integers(0, 2**32 - 1)
FLOATS = st.floats(allow_nan=False)


class Host:
    """What a host does, packet by packet, at times that the test chooses."""

    def __init__(self, session: int = 7) -> None:
        self.session, self.number, self.time = session, 0, 0

    def ask(self, device: DeviceLogic, now: int, command: float | None = None) -> State | None:
        self.number += 1
        values = [0.0 if command is None else command]
        request = Request(1, self.session, self.number, 0, self.time, command is not None, values)
        answer = device.receive(request.packet(), now)
        if answer is None:
            return None
        state = read_state(answer)
        self.time = state.time
        return state


def device(stands: float = 0.4) -> DeviceLogic:
    made = DeviceLogic(
        LIMITS, 1, 1, lambda: ([0.3], [0.0], [made.command[0] if made.command else stands], [4.0])
    )
    return made


def test_a_request_is_these_bytes() -> None:
    told = Request(1, 0x01020304, 5, 6, 7, True, [1.0]).packet()
    assert told.hex(" ") == (
        "52 54 48 4d 01 01 01 01 04 03 02 01 05 00 00 00 06 00 00 00 07 00 00 00 01 00 00 00 00 00 00 00"
        " 00 00 00 00 00 00 f0 3f"
    )


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS, st.lists(FLOATS, min_size=1, max_size=16))
def test_packets_are_read_as_they_were_written(a: int, b: int, c: int, d: int, values: list[float]) -> None:
    request = Request(2, a, b, c, d, True, tuple(values))
    assert read_request(request.packet()) == request
    state = State(a, b, c, d, 3, tuple(values), tuple(values), (1.0, 2.0), (3.0, 4.0))
    assert read_state(state.packet()) == state


@given(st.binary(max_size=80))
def test_what_is_no_packet_is_refused(data: bytes) -> None:
    for read in (read_request, read_state):
        with pytest.raises(ValueError, match=r"is no|has|is of"):
            read(data)
        with pytest.raises(ValueError, match=r"is no|has|is of"):
            read(Request(1, 1, 1, 1, 1, True, [1.0]).packet()[:-1] + data * 2)
    assert device().receive(data, 0) is None


def test_numbers_go_on_where_they_wrap_around() -> None:
    assert packets.ahead(3, 2**32 - 2) == 5
    assert packets.ahead(2**32 - 2, 3) == -5


def test_a_device_answers_with_what_its_sensors_read() -> None:
    state = Host().ask(device(), 1000)
    assert state == State(7, 1, 1, 1000, 0, (0.3,), (0.0,), (0.4,), (4.0,))


def test_a_command_counts_from_where_the_motor_stands() -> None:
    rig, host = device(), Host()
    host.ask(rig, 0)
    assert host.ask(rig, 1000, 0.45).flags == FAR
    assert rig.command is None
    assert host.ask(rig, 2000, 0.405).flags == ARMED
    assert rig.command == pytest.approx([0.405])


@pytest.mark.parametrize("value", [math.nan, math.inf, 1.1])
def test_a_command_that_is_no_number_or_too_large_is_not_executed(value: float) -> None:
    rig, host = device(), Host()
    host.ask(rig, 0)
    assert host.ask(rig, 1000, value).flags == BAD
    assert rig.command is None


def test_a_command_that_was_delayed_on_its_way_is_not_executed_whatever_clock_the_host_has() -> None:
    rig, host = device(), Host()
    assert host.ask(rig, 60_000, 0.4).flags == OLD  # a host that has seen no state yet
    assert host.ask(rig, 61_000, 0.4).flags == ARMED
    held = Request(1, 7, host.number + 1, 0, host.time, True, [0.41]).packet()
    assert read_state(rig.receive(held, 61_000 + 50_001)).flags == OLD
    assert rig.receive(held, 120_000) is None  # and never again


def test_the_clock_of_a_device_may_wrap_around() -> None:
    rig, host = device(), Host()
    host.ask(rig, 2**32 - 1000)
    assert host.ask(rig, 1000, 0.4).flags == ARMED
    assert not rig.watch(51_000)
    assert rig.watch(51_001)


def test_a_command_moves_within_the_rate_however_long_the_pause_was() -> None:
    rig, host = device(), Host()
    host.ask(rig, 0)
    host.ask(rig, 1000, 0.4)
    host.ask(rig, 3000, 0.5)
    assert rig.command == pytest.approx([0.41])
    host.ask(rig, 43_000, 0.5)
    assert rig.command == pytest.approx([0.43])
    host.ask(rig, 43_000, 0.5)
    assert rig.command == pytest.approx([0.43])


def test_without_a_fresh_command_the_motors_hold_and_a_new_one_begins_there() -> None:
    rig, host = device(), Host()
    host.ask(rig, 0)
    host.ask(rig, 1000, 0.4)
    for k in range(2, 51):
        assert host.ask(rig, 1000 * k).flags == ARMED  # asking alone keeps nobody under command
    assert host.ask(rig, 51_001).flags == 0
    assert rig.command is None
    assert host.ask(rig, 52_000, 0.5).flags == FAR
    assert host.ask(rig, 53_000, 0.4).flags == ARMED


def test_a_second_host_is_not_heard_while_the_motors_are_under_command() -> None:
    rig, host, thief = device(), Host(), Host(8)
    host.ask(rig, 0)
    host.ask(rig, 1000, 0.4)
    assert thief.ask(rig, 2000, 0.405) is None
    assert host.ask(rig, 3000, 0.402).flags == ARMED
    assert thief.ask(rig, 60_000) is not None
