from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_core.clock import NS, Clock, Rank, to_ns
from rthm_core.errors import InputError

PERIODS = st.integers(1, 10**12)
INSTANTS = st.integers(0, 10**18)


@given(PERIODS, st.integers(0, 10**9))
def test_a_clock_never_drifts(period: int, k: int) -> None:
    assert Clock(period).tick(k) == k * period
    assert Clock(period).tick(k + 1) - Clock(period).tick(k) == period


@given(PERIODS, INSTANTS)
def test_the_newest_tick_is_at_or_before_the_instant_and_the_next_one_after_it(period: int, ns: int) -> None:
    clock = Clock(period)
    k = clock.index_at(ns)
    assert clock.tick(k) <= ns < clock.tick(k + 1)


@given(PERIODS, st.integers(0, 10**6))
def test_the_tick_at_an_instant_belongs_to_that_instant(period: int, k: int) -> None:
    clock = Clock(period)
    assert clock.index_at(clock.tick(k)) == k
    assert clock.index_at(clock.tick(k) - 1) == k - 1


def test_no_tick_precedes_the_start() -> None:
    clock = Clock(1_200_000)
    assert clock.index_at(-1) == clock.index_at(-(10**15)) == -1


def test_seconds_are_rounded_and_not_truncated() -> None:
    assert int(0.0157 * 1e9) == 15_699_999  # what truncation would give
    assert to_ns(0.0157) == 15_700_000


@given(st.floats(-1e5, 1e5))
def test_no_instant_is_more_than_half_a_nanosecond_off(seconds: float) -> None:
    assert abs(to_ns(seconds) - Fraction(seconds) * NS) <= Fraction(51, 100)


@pytest.mark.parametrize("seconds", [float("nan"), float("inf"), -float("inf"), 1e10])
def test_a_time_that_no_stamp_can_hold_is_refused(seconds: float) -> None:
    with pytest.raises(InputError, match="finite number of seconds"):
        to_ns(seconds)


@pytest.mark.parametrize("period", [0, -1])
def test_a_clock_needs_a_period(period: int) -> None:
    with pytest.raises(InputError, match="at least 1 ns"):
        Clock(period)


def test_at_one_instant_delays_end_before_sampling_and_the_controller_is_last() -> None:
    assert sorted(Rank, key=int) == [Rank.DELAY, Rank.SAMPLE, Rank.NUMERICAL, Rank.CONTROL]
