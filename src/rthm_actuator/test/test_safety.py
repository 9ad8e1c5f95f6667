from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_actuator.safety import Expected, SafetyMonitor
from rthm_actuator.shaping import Rig
from rthm_actuator.supervision import Broken
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.spec import LimitsSpec

MS = 1_000_000
REST = np.array([0.4, -0.1])
UNLOADED = np.array([0.3, -0.2])
STIFFNESS = np.array([40.0, 25.0])
STATE, REFERENCE = "plant/state", "numerical/force_reference"
INPUTS = {STATE: Expected(4 * MS, 2 * MS), REFERENCE: Expected(12 * MS, 12 * MS)}

ANY = st.floats() | st.floats(-2.0, 2.0)
PAIRS = st.tuples(ANY, ANY).map(np.array)
POSITIVE = st.floats(0.02, 5.0)
STEPS = st.lists(
    st.tuples(st.integers(0, 40 * MS), PAIRS, PAIRS, st.booleans(), PAIRS), min_size=1, max_size=60
)


def monitor(end: int = 0, **limits: object) -> SafetyMonitor:
    safety = SafetyMonitor(LimitsSpec(**limits), Rig(STIFFNESS, 100 * NS, lambda: UNLOADED), INPUTS, end)
    safety.arm(REST)
    return safety


def feed(safety: SafetyMonitor, at: int) -> None:
    safety.accept(STATE, at, at, REST)
    safety.accept(REFERENCE, at, at, REST)


def commanded(safety: SafetyMonitor, at: int, u_d: np.ndarray, x1: np.ndarray = REST) -> np.ndarray:
    sent = safety.command(at, at, u_d, x1)
    assert sent is not None
    return sent


@given(st.fixed_dictionaries({}, optional={"force": POSITIVE, "stale": POSITIVE, "ramp": POSITIVE}), STEPS)
def test_no_input_whatever_gets_a_command_over_the_limits(limits: dict[str, float], steps: list) -> None:
    safety = monitor(end=NS, command=0.5, rate=3.0, **limits)
    at, last = 0, REST
    for wait, u_d, x1, fresh, force in steps:
        at += wait
        if fresh and safety.accept(REFERENCE, at, at, force):
            assert np.all(np.abs(safety.reference(force)) <= limits.get("force", math.inf))
        if fresh:
            safety.accept(STATE, at, at, x1)
        sent = commanded(safety, at, u_d, np.nan_to_num(x1, posinf=0.0, neginf=0.0))
        assert np.all(np.isfinite(sent))
        assert np.all(np.abs(sent) <= 0.5)
        assert np.all(np.abs(sent - last) <= 3.0 * wait / NS * (1 + 1e-12) + 1e-15)
        last = sent


@given(st.lists(st.tuples(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300)).map(np.array), max_size=20))
def test_without_limits_every_finite_command_passes_to_the_last_bit(commands: list[np.ndarray]) -> None:
    safety = monitor()
    for k, u_d in enumerate(commands):
        assert commanded(safety, k * NS, u_d, REST).tobytes() == u_d.tobytes()
    assert safety.reason == ""


@given(st.lists(st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01)).map(np.array), max_size=50))
def test_within_all_limits_a_command_passes_to_the_last_bit(moves: list[np.ndarray]) -> None:
    safety = monitor(command=1.0, rate=50.0, force=100.0, stale=0.05)
    for k, move in enumerate(moves, start=1):
        feed(safety, k * 4 * MS)
        assert commanded(safety, k * 4 * MS, REST + move, REST).tobytes() == (REST + move).tobytes()
    assert not any(safety.limited.values())


@pytest.mark.parametrize("fault", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("where", [STATE, REFERENCE, "command"])
def test_a_number_that_is_not_finite_stops_the_motors_where_they_are_even_without_limits(
    fault: float, where: str
) -> None:
    safety = monitor()
    bad = np.array([0.1, fault])
    last = commanded(safety, MS, np.array([0.3, 0.2]), REST)
    if where == "command":
        sent = commanded(safety, 2 * MS, bad, REST)
    else:
        assert not safety.accept(where, 2 * MS, 2 * MS, bad)
        sent = commanded(safety, 2 * MS, np.array([0.5, 0.5]), REST)
    assert np.array_equal(sent, last)
    assert "not finite" in safety.reason
    assert np.array_equal(commanded(safety, 3 * NS, np.array([0.5, 0.5]), REST), last)


def test_a_stale_input_brings_the_motors_back_to_rest_at_once() -> None:
    safety = monitor(stale=0.05, ramp=1.0)
    out, u_d = {}, REST + 0.2
    for k in range(1000):
        at = k * 4 * MS
        safety.accept(REFERENCE, at, at, REST)
        if at <= 1500 * MS:
            safety.accept(STATE, at, at, REST)
        out[k * 4] = commanded(safety, at, u_d)
    assert safety.reason == "plant/state has had no fresh sample for 0.052 s"
    assert safety.abort is not None
    assert safety.abort.as_dict() == {
        "at": 1.552, "limit": "stale", "value": 0.052, "allowed": 0.05, "words": safety.reason,
    }  # fmt: skip
    assert np.array_equal(out[1548], u_d)
    assert np.allclose(out[2052], REST + 0.1, atol=1e-3)
    assert np.array_equal(out[2552], REST)
    assert safety.at_rest


def test_nothing_is_stale_before_the_first_sample_can_have_come() -> None:
    safety = monitor(stale=0.013)
    for at in range(0, 17 * MS, MS):
        commanded(safety, at, REST, REST)
    assert safety.reason == ""
    commanded(safety, 18 * MS, REST, REST)
    assert safety.reason.startswith("plant/state")


def test_commands_fade_in_and_out_over_the_ramp() -> None:
    safety = monitor(end=10 * NS, ramp=2.0)
    u_d = REST + np.array([1.0, -2.0])
    sent = [commanded(safety, t * NS, u_d, REST) for t in range(11)]
    assert np.array_equal(sent[0], REST)
    assert sent[1] == pytest.approx(REST + np.array([0.5, -1.0]))
    assert all(np.array_equal(sent[t], u_d) for t in range(2, 9))
    assert sent[9] == pytest.approx(sent[1])
    assert np.array_equal(sent[10], REST)


def test_the_force_between_command_and_plant_stays_within_its_limit() -> None:
    safety = monitor(force=4.0)
    x1 = np.array([0.3, 0.3])
    sent = commanded(safety, MS, np.array([0.9, 0.31]), x1)
    assert STIFFNESS * (sent - x1) == pytest.approx([4.0, 0.25])
    assert safety.limited["force"] == 1


def test_a_stopped_test_goes_to_rest_without_waiting() -> None:
    safety = monitor(stale=0.5, ramp=1.0)
    feed(safety, 2 * NS)
    commanded(safety, 2 * NS, REST + 0.2, REST)
    safety.stop(2 * NS, "deactivated")
    assert np.allclose(commanded(safety, 2 * NS + 500 * MS, REST, REST), REST + 0.1)
    assert np.array_equal(commanded(safety, 3 * NS, REST, REST), REST)


def test_what_fails_while_the_motors_go_back_anyway_is_no_abort() -> None:
    safety = monitor(stale=0.05, ramp=1.0)
    feed(safety, 2 * NS)
    commanded(safety, 2 * NS, REST + 0.2)
    safety.stop(2 * NS, "deactivated")
    for k in range(260):
        commanded(safety, 2 * NS + k * 4 * MS, REST)
    assert safety.abort is None
    assert safety.at_rest


def test_what_stopped_the_monitor_first_is_what_it_tells() -> None:
    safety = monitor(stale=0.05)
    safety.accept(STATE, 0, 0, np.array([math.nan, 0.0]))
    commanded(safety, NS, REST, REST)
    assert safety.reason == "plant/state is not finite"


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"command": 0.3}, "limits.command is 0.3"),
        ({"stale": 0.012}, "limits.stale is 0.012"),
        ({"age": 0.02}, "limits.age is 0.02"),
    ],
)
def test_limits_that_cannot_be_kept_are_refused(limits: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        monitor(**limits)


def test_data_that_are_old_where_they_are_used_end_the_test_however_often_they_come() -> None:
    safety = monitor(stale=0.05, age=0.05, ramp=0.1)
    for k in range(200):
        at = k * 4 * MS
        safety.accept(REFERENCE, at, at, REST)
        safety.accept(STATE, at - 500 * MS if at > 200 * MS else at, at, REST)
        commanded(safety, at, REST)
    assert safety.abort is not None
    assert safety.abort.limit == "age"
    assert safety.abort.value == pytest.approx(0.052)


def test_a_sample_that_becomes_too_old_because_none_follows_is_called_stale() -> None:
    safety = monitor(stale=0.05, age=0.05)
    for k in range(100):
        at = k * 4 * MS
        safety.accept(REFERENCE, at, at, REST)
        if at <= 200 * MS:
            safety.accept(STATE, at - 20 * MS, at, REST)
        commanded(safety, at, REST)
    assert safety.abort is not None
    assert (safety.abort.limit, safety.abort.at) == ("stale", 0.232)


def test_a_sample_from_the_future_ends_the_test() -> None:
    safety = monitor(stale=0.05, age=0.05)
    safety.heard(STATE, 2 * NS, NS)
    assert safety.abort is not None
    assert safety.abort.limit == "age"
    assert "1.000 s in the future" in safety.abort.words


def test_messages_that_cannot_be_used_are_the_words_of_what_is_stale() -> None:
    safety = monitor(stale=0.05)
    feed(safety, 0)
    safety.unread(STATE, "a message on plant/state names y1, but not x1")
    commanded(safety, 60 * MS, REST)
    assert safety.reason.endswith(
        "no fresh sample for 0.060 s: a message on plant/state names y1, but not x1"
    )


def test_stamps_in_the_past_are_the_words_of_what_is_stale() -> None:
    safety = monitor(stale=0.05, age=0.05)
    feed(safety, NS)
    safety.heard(STATE, 60 * MS, NS + 60 * MS)
    commanded(safety, NS + 60 * MS, REST)
    assert safety.reason.endswith("the last one that came is stamped 1.000 s in the past")


@pytest.mark.parametrize(("on_abort", "rest"), [("return", REST), ("hold", REST + 0.1), ("unload", UNLOADED)])
def test_an_abort_ends_where_it_is_told_to(on_abort: str, rest: np.ndarray) -> None:
    safety = monitor(ramp=1.0, on_abort=on_abort)
    commanded(safety, 2 * NS, REST + 0.1)
    safety.judge(2 * NS, Broken("step", 1.0, 0.1, "the position sensor steps"))
    way = [commanded(safety, 2 * NS + k * 100 * MS, REST + 0.3) for k in range(1, 12)]
    assert np.allclose(way[4], (REST + 0.1 + rest) / 2.0)
    assert np.array_equal(way[-1], rest)
    assert safety.at_rest


def test_an_unloading_whose_force_sensor_is_lost_holds_the_motors() -> None:
    safety = monitor(ramp=1.0, on_abort="unload")
    commanded(safety, 2 * NS, REST + 0.1)
    safety.judge(2 * NS, Broken("operator", None, None, "asked for"))
    half = commanded(safety, 2 * NS + 500 * MS, REST)
    safety.judge(2 * NS + 500 * MS, Broken("finite", None, None, "the force sensor", ("force",)))
    assert np.array_equal(commanded(safety, 4 * NS, REST), half)
    assert safety.abort is not None
    assert safety.abort.limit == "operator"  # the first one is told


def test_a_command_at_a_limit_for_too_long_ends_the_test() -> None:
    safety = monitor(command=0.5, hold=0.5)
    for k in range(140):
        commanded(safety, k * 4 * MS, REST + 0.3 * (k >= 10))
    assert safety.abort is not None
    assert safety.abort.limit == "hold"
    assert safety.abort.at == pytest.approx(0.544)


def test_nothing_is_commanded_before_the_rig_is_armed_and_then_from_where_it_stands() -> None:
    rig = Rig(STIFFNESS, 4 * MS, lambda: UNLOADED)
    safety = SafetyMonitor(LimitsSpec(command=1.0, rate=5.0, ramp=0.5), rig, INPUTS)
    assert safety.command(0, 0, REST, REST) is None
    stands = np.array([0.1, 0.2])
    safety.arm(stands, 8 * MS)
    assert np.array_equal(commanded(safety, 8 * MS, REST), stands)
    sent = [commanded(safety, 8 * MS + k * 4 * MS, REST) for k in range(1, 130)]
    assert np.abs(np.diff([stands, *sent], axis=0)).max() <= 5.0 * 0.004
    assert np.array_equal(sent[-1], REST)


def test_a_burst_of_commands_after_a_pause_is_no_jump() -> None:
    safety = SafetyMonitor(LimitsSpec(rate=5.0), Rig(STIFFNESS, 4 * MS, lambda: UNLOADED), INPUTS)
    safety.arm(REST)
    first = safety.command(NS, NS, REST + 1.0, REST)
    second = safety.command(NS + 4 * MS, NS + MS, REST + 1.0, REST)
    assert first is not None
    assert second is not None
    assert first - REST == pytest.approx([0.02, 0.02])
    assert second - first == pytest.approx([0.005, 0.005])
