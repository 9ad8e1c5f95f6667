"""The loop in real time, with a clock and an executor made by hand."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace

import pytest

from rthm_core.clock import NS, Rank
from rthm_core.ros.agenda import Agenda
from rthm_core.ros.alive import PERIOD
from rthm_core.ros.realtime import RealTime

MS = NS // 1000


class Host:
    """A clock that moves on while the executor waits, which messages may end early."""

    def __init__(self, messages: int) -> None:
        self.at, self._messages = 0, messages

    def now(self) -> int:
        self.at += 1000
        return self.at

    def spin_once(self, timeout_sec: float) -> None:
        wait = round(timeout_sec * NS)
        self.at += min(wait, self._messages) if self._messages else wait


@pytest.mark.parametrize("messages", [0, MS])
def test_there_is_always_time_for_a_beat_also_just_before_the_first_tick(messages: int) -> None:
    host, agenda, ticks = Host(messages), Agenda(), list[int]()
    agenda.every("Td3", 4 * MS, Rank.CONTROL, lambda at, now: ticks.append(at))
    ports = SimpleNamespace(start=NS, flush=lambda: None)
    loop = RealTime(host, agenda, ports, margin=200_000)  # type: ignore[arg-type]
    loop._clock = host  # type: ignore[assignment]
    quiet = [0]
    while not ticks:
        if loop.turn():
            quiet.append(host.at)
    longest = max(after - before for before, after in pairwise(quiet))
    assert longest <= 2 * PERIOD + MS
