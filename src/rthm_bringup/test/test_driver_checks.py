"""Each fault of a driver is found by the check that is named after it, and by no other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_bringup.driver.answer import check_swing, fitted_delay, swing
from rthm_bringup.driver.checks import checks_of
from rthm_bringup.driver.heard import Commanded, Heard, Publisher, Sample
from rthm_core.errors import InputError
from rthm_core.spec import apply, shipped_spec
from rthm_core.topics import JOINT_STATE

SPEC = shipped_spec("paper")
TD1, NAN = 1_200_000, float("nan")
START = 1_700_000_000_123_456_789


def sample(k: int, stamp: int | None = None, **changes: object) -> Sample:
    """The k-th sample of a driver without fault; it arrives 0.5 ms after its tick."""
    due = START + k * TD1
    one = Sample(
        due if stamp is None else stamp, due + 500_000, k, ("x1", "a1"), (0.5, 0.4), (0.1, NAN), (NAN, 2.0)
    )
    return replace(one, **changes)


def heard(samples: list[Sample] | None = None, **changes: object) -> Heard:
    kept = [sample(k) for k in range(2000)] if samples is None else samples
    return replace(Heard((Publisher("/rthm/driver", JOINT_STATE, True),), tuple(kept), True), **changes)


def failed(of: Heard) -> list[str]:
    return [one.name for one in checks_of(of, SPEC) if not one.passed]


def test_a_driver_without_fault_passes_everything() -> None:
    checks = checks_of(heard(), SPEC)
    assert len(checks) == 16 and all(one.passed for one in checks)
    figures = {one.name: one.value for one in checks}
    assert figures["period"] == pytest.approx(1.2e-3, rel=1e-12)
    assert figures["clock grid"] < 1e-12
    assert figures["arrives in time"] == pytest.approx(5e-4)


def test_a_silent_topic_is_told_without_checks_of_its_samples() -> None:
    assert failed(heard([], publishers=())) == ["one publisher", "samples"]


def test_who_publishes_and_how_is_checked() -> None:
    driver = Publisher("/rthm/driver", JOINT_STATE, True)
    assert failed(heard(publishers=(driver, driver))) == ["one publisher"]
    assert failed(heard(publishers=(replace(driver, reliable=False),))) == ["reliable"]
    assert failed(heard([], publishers=(replace(driver, type_name="std_msgs/msg/String"),))) == [
        "type",
        "samples",
    ]
    assert failed(heard(listens=False)) == ["commands"]


def with_one(k: int, **changes: object) -> Heard:
    """Everything right but one sample."""
    return heard([sample(i, **(changes if i == k else {})) for i in range(2000)])


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        ({"names": ("a1", "x1")}, ["names"]),
        ({"names": ("x1",)}, ["names", "sizes"]),
        ({"position": (0.5,)}, ["sizes"]),
        ({"velocity": ()}, ["numbers"]),
        ({"velocity": (NAN, 0.0)}, ["numbers"]),
        ({"position": (0.5, NAN)}, ["numbers"]),
        ({"effort": (0.0, NAN)}, ["numbers"]),
        ({"effort": (float("inf"), 2.0)}, ["numbers"]),
        ({"effort": (NAN, 2.0), "velocity": (0.1, 0.2)}, []),
    ],
)
def test_what_a_sample_holds_is_checked(changes: dict[str, object], names: list[str]) -> None:
    assert failed(with_one(700, **changes)) == names


def test_a_velocity_is_needed_only_where_the_interface_damps() -> None:
    bare = apply(SPEC, {"interface.damping": [0.0]})
    checks = checks_of(heard([sample(k, velocity=()) for k in range(100)]), bare)
    assert all(one.passed for one in checks)


def test_a_repeated_stamp_is_found_and_leaves_its_own_tick_empty() -> None:
    of = with_one(700, stamp_ns=START + 699 * TD1)
    assert failed(of) == ["stamps increase", "no tick left out"]


def test_stamps_in_whole_milliseconds_are_off_the_grid() -> None:
    of = heard([sample(k, (START + k * TD1) // 10**6 * 10**6) for k in range(2000)])
    assert {"clock grid", "period jitter"} <= set(failed(of))
    assert "stamps increase" not in failed(of) and "no tick left out" not in failed(of)


def test_a_period_with_rounding_is_found() -> None:
    of = heard([sample(k, START + k * 1_201_000) for k in range(2000)])
    (period,) = [one for one in checks_of(of, SPEC) if one.name == "period"]
    assert not period.passed
    assert period.value == pytest.approx(1.201e-3, rel=1e-9)


def test_a_tick_that_the_driver_left_out_is_told_from_a_sample_lost_on_the_way() -> None:
    rest = [sample(k) for k in range(2000) if k != 700]
    assert failed(heard(rest)) == ["nothing lost"]
    counted = [replace(one, number=i) for i, one in enumerate(rest)]
    assert "no tick left out" in failed(heard(counted)) and "nothing lost" not in failed(heard(counted))


def test_stamps_of_a_clock_that_runs_ahead_are_in_the_future() -> None:
    of = heard([sample(k, START + k * TD1 + 700_000) for k in range(2000)])
    assert failed(of) == ["same clock"]


def test_a_sample_that_comes_after_its_use_is_late() -> None:
    of = heard([sample(k, START + k * TD1 - 4_000_000) for k in range(2000)])
    assert failed(of) == ["arrives in time"]


def test_motors_that_follow_are_told_from_motors_that_stand() -> None:
    at = np.arange(0.0, 2.4, 1.2e-3)
    sent = np.arange(0.0, 2.4, 4e-3)
    command = np.array([swing(np.array([0.4]), 0.02, t / 2.4) for t in sent])
    commanded = Commanded(START + np.rint(sent * 1e9).astype(np.int64), command)
    moved = np.interp(at - 0.02, sent, command[:, 0])
    answering = [sample(k, position=(0.5, u)) for k, u in enumerate(moved)]
    assert failed(heard(answering, commanded=commanded)) == []
    assert failed(heard(commanded=commanded)) == ["answers"]
    assert fitted_delay(at, moved, sent, command[:, 0])[0] == pytest.approx(0.02, abs=1e-3)


def test_a_swing_stays_within_the_limits_of_the_spec() -> None:
    limited = apply(SPEC, {"limits.command": 0.411, "limits.rate": 0.1})
    check_swing(np.array([0.4]), 0.01, 2.0, limited)
    with pytest.raises(InputError, match=r"a command of 0.42 m"):
        check_swing(np.array([0.4]), 0.02, 2.0, limited)
    with pytest.raises(InputError, match=r"a rate of 0.3142 m/s"):
        check_swing(np.array([0.4]), 0.01, 0.1, limited)
    with pytest.raises(InputError, match="no motor positions"):
        check_swing(np.array([np.nan]), 0.01, 1.0, limited)
