"""What a leader notices while a test runs, without a graph."""

from __future__ import annotations

import os
import time

import pytest

from rthm_bringup.run.heartbeats import Heartbeats
from rthm_bringup.run.keys import Keys


def test_a_node_that_falls_silent_is_found_and_others_are_not() -> None:
    beats = Heartbeats({"plant", "actuator"}, 0.2)
    found, now = None, 0.0
    while found is None:
        now += 0.02
        beats.beat("plant")
        beats.beat("a stranger")
        if now < 1.0:
            beats.beat("actuator")
        found = beats.look(now)
    assert found.name == "actuator"
    assert 0.2 < found.seconds < 0.25
    assert 1.18 < now < 1.24


def test_a_node_counts_from_its_first_beat() -> None:
    beats = Heartbeats({"plant"}, 0.2)
    assert all(beats.look(0.02 * k) is None for k in range(1000))


def test_a_listener_whose_host_stalled_calls_nobody_silent() -> None:
    beats = Heartbeats({"plant"}, 0.2)
    for now in (0.0, 0.05, 3.05, 3.06, 7.0):
        assert beats.look(now) is None
        beats.beat("plant")
    assert beats.look(20.0) is None
    assert beats.look(20.05) is None


@pytest.mark.parametrize(("limit", "least"), [(0.2, 1.0), (2.0, 2.0)])
def test_a_listener_tells_once_how_long_its_host_stalled(limit: float, least: float) -> None:
    beats, told, now = Heartbeats({"plant"}, limit), [], 100.0
    for between in (0.02, 0.9 * least, 0.02, least + 0.1, 0.02, 0.02):
        now += between
        beats.look(now)
        told.append(beats.deaf)
    assert told == [0.0, 0.0, 0.0, pytest.approx(least + 0.1), 0.0, 0.0]


def test_keys_are_seen_without_enter_and_the_terminal_is_left_as_it_was() -> None:
    import termios

    hand, terminal = os.openpty()
    before = termios.tcgetattr(terminal)
    with Keys(terminal) as keys:
        assert keys.watched
        assert keys.pressed() == ""
        os.write(hand, b"a")
        deadline, seen = time.monotonic() + 10.0, ""
        while not seen and time.monotonic() < deadline:
            seen = keys.pressed()
        assert seen == "a"
        assert keys.pressed() == ""
    assert termios.tcgetattr(terminal) == before
    os.close(hand)
    os.close(terminal)
