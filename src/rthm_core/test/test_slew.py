from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_core.clock import NS
from rthm_core.events import Abort, abort_of, read_event, write_abort, write_event
from rthm_core.slew import Slew

MS = 1_000_000
WAITS = st.integers(0, 2 * NS)


@given(st.lists(st.tuples(WAITS, WAITS, st.floats(-3.0, 3.0)), min_size=1, max_size=40))
def test_no_step_is_above_the_rate_by_stamps_by_the_clock_or_in_one_period(
    steps: list[tuple[int, int, float]],
) -> None:
    slew, at, now, last = Slew(5.0, np.array([0.1]), 4 * MS), 0, 0, 0.1
    for stamps, clock, wanted in steps:
        at, now = at + stamps, now + clock
        value = float(slew.to(np.array([wanted]), at, now)[0])
        passed = min(stamps, clock, 4 * MS) / NS
        assert abs(value - last) <= 5.0 * passed + 1e-14
        last = value


def test_what_was_limited_once_passes_a_second_limiter_to_the_last_bit() -> None:
    first, second = Slew(5.0, np.array([0.1]), 4 * MS), Slew(5.0, np.array([0.1]), 4 * MS)
    for k in range(1, 200):
        value = first.to(np.array([0.7]), k * 4 * MS, k * 4 * MS)
        again = second.to(value, k * 4 * MS, k * 4 * MS)
        assert again.tobytes() == value.tobytes()


def test_without_a_rate_everything_passes() -> None:
    assert Slew(None, np.array([0.0]), MS).to(np.array([9.0]), 0, 0) == pytest.approx([9.0])


def test_an_abort_is_what_was_told() -> None:
    abort = Abort(3.008, "step", 0.3, 0.012, "the position sensor of x1 steps by 0.3 m")
    assert abort_of(read_event(write_abort(abort))) == abort
    assert abort.sentence == "Aborted at 3.008 s: the position sensor of x1 steps by 0.3 m"
    lost = Abort(3.008, "finite", float("nan"), None, "the force sensor of a1 reads not a number")
    assert lost.as_dict()["value"] is None


@pytest.mark.parametrize("text", ["", "no json", "[]", "{}", '{"event": 3}', '"abort"'])
def test_what_is_no_event_is_none(text: str) -> None:
    assert read_event(text) == {}
    assert abort_of(read_event(text)) is None


def test_an_abort_without_figures_is_an_abort_and_other_events_are_none() -> None:
    found = abort_of(read_event('{"event": "abort", "value": "much"}'))
    assert found == Abort(0.0, "unknown", None, None, "without a word")
    assert abort_of(read_event(write_event("armed", at=0.0, motor=[float("nan")]))) is None
