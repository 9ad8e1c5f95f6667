from __future__ import annotations

import math

import numpy as np
import pytest

from rthm_core.clock import NS
from rthm_core.spec import LimitsSpec
from rthm_plant_sim.guard import CommandGuard

MS = 1_000_000
REST = np.array([0.4])


def guard(**limits: float) -> CommandGuard:
    return CommandGuard(LimitsSpec(**limits), REST, 4 * MS)


def test_without_limits_every_finite_command_is_executed_to_the_last_bit() -> None:
    free = guard()
    for k in range(20):
        u_d = REST + 1e3 * math.sin(k)
        assert free.executed(0, k * NS, u_d) is u_d
    assert free.executed(0, NS, np.array([math.nan])) is None
    assert free.refused["finite"] == 1


@pytest.mark.parametrize(
    ("stamp", "value", "limit"),
    [
        (-51, 0.4, "command_age"),
        (-10, 1.1, "command"),
        (-10, math.inf, "finite"),
        (-3990, 0.4, "command_age"),
    ],
)
def test_a_forged_or_late_command_moves_nothing(stamp: int, value: float, limit: str) -> None:
    kept = guard(command=1.0, rate=5.0, command_age=0.05)
    assert kept.executed(NS + stamp * MS, NS, np.array([value])) is None
    assert kept.refused[limit] == 1


def test_after_a_cut_the_queue_is_dropped_and_the_motors_go_on_within_their_rate() -> None:
    kept, last, moved = guard(command=1.0, rate=5.0, command_age=0.05), 0.4, []
    cut, back = NS, 6 * NS
    arrivals = [(k * 4 * MS, k * 4 * MS + 10 * MS) for k in range(cut // (4 * MS))]
    arrivals += [(cut + k * 4 * MS, back + k // 4 * MS) for k in range((back - cut) // (4 * MS))]
    arrivals += [(back + k * 4 * MS, back + 400 * MS + k * 4 * MS) for k in range(10)]
    arrivals += [(back + 400 * MS + k * 4 * MS, back + 410 * MS + k * 4 * MS) for k in range(100)]
    for stamp, at in arrivals:
        value = kept.executed(stamp, at, np.array([0.4 + 0.3 * math.sin(stamp / NS)]))
        if value is not None:
            moved.append((at, float(value[0]) - last))
            last = float(value[0])
    assert kept.refused["command_age"] > 1000
    times, steps = np.array(moved).T
    assert np.all(np.abs(steps[1:]) <= 5.0 * np.diff(times) / NS + 1e-12)
    assert np.abs(steps).max() <= 5.0 * 0.004 + 1e-12


def test_a_silence_is_told_once_and_again_after_the_next_command() -> None:
    kept = guard(command_age=0.05)
    assert kept.silent(NS) is None  # nobody has commanded yet
    kept.executed(NS, NS, REST)
    assert kept.silent(NS + 50 * MS) is None
    assert kept.silent(NS + 51 * MS) == pytest.approx(0.051)
    assert kept.silent(NS + 60 * MS) is None
    kept.executed(2 * NS, 2 * NS, REST)
    assert kept.silent(3 * NS) == pytest.approx(1.0)
