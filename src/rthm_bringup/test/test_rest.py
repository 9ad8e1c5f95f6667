"""The zero of a rig that rests, and the refusal of one that does not."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_actuator.sensors import FORCE, MOTOR, POSITION, VELOCITY, Sensors
from rthm_bringup.driver.rest import Reading, readings, unrest
from rthm_bringup.driver.tightening import approach
from rthm_bringup.driver.zeroing import slack_zero, tensioned, zeroed
from rthm_bringup.run.stopped import StoppedError
from rthm_bringup.run.zero import check_tension, zero_of
from rthm_core.errors import InputError
from rthm_core.spec import apply, read_spec, shipped_spec, write_spec

LIMITS = {"command": 1.0, "rate": 5.0, "force": 50.0, "stale": 0.05, "ramp": 0.5, "start": [0.01, 0.5]}
RIG = apply(shipped_spec(), {"limits": LIMITS})
ALL = frozenset({POSITION, VELOCITY, MOTOR, FORCE})


def at_rest(*, drift: float = 0.0, force: float = 0.37) -> list[Reading]:
    """Three seconds of a rig, whose load cell drifts by so many N."""
    draw, count = np.random.default_rng(1).standard_normal, 2500
    slope = drift * np.linspace(0.0, 1.0, count)
    rows = np.column_stack(
        [
            0.021 + 1e-4 * draw(count),
            np.full(count, np.nan),
            -0.003 + 1e-5 * draw(count),
            force + slope + 0.02 * draw(count),
        ]
    )
    return readings(Sensors(RIG).channels, rows, (0.01, 0.5))


def test_means_become_the_zero_and_their_uncertainty_holds() -> None:
    found = at_rest()
    assert unrest(found) == ""
    for one, true in zip(found, (0.021, None, -0.003, 0.37), strict=True):
        assert true is None or abs(one.mean - true) < 3.5 * one.std
    assert found[1].line.endswith("not measured")
    done = read_spec(write_spec(zeroed(RIG, found, ALL)))
    assert done.zero is not None
    assert done.zero.force == pytest.approx([0.37], abs=2e-3)
    assert done.zero.velocity is None
    assert zero_of(done)["zero.velocity"] == (0.0,)
    assert zero_of(done)["zero.position"] == done.zero.position


def test_a_rig_that_moves_is_refused_with_figures() -> None:
    words = unrest(at_rest(drift=0.5))
    assert "the force sensor of a1 moved by 0.4" in words
    assert "0.05 N are allowed; let it come to rest" in words


def test_only_what_is_asked_for_is_zeroed_again() -> None:
    first = zeroed(RIG, at_rest(), ALL)
    second = zeroed(first, at_rest(force=1.0), frozenset({FORCE}))
    assert second.zero is not None and first.zero is not None
    assert second.zero.position == first.zero.position
    assert second.zero.force == pytest.approx([1.0], abs=2e-3)


def test_a_measured_tension_is_the_pretension_and_no_longer_a_force() -> None:
    slack = apply(zeroed(RIG, at_rest(), ALL), {"actuator.pretension": [5.0]})
    with pytest.raises(StoppedError, match=r"pretension of a1 is 5 N by the spec and was not measured"):
        check_tension(slack)
    tight = tensioned(slack, at_rest(force=5.2))
    assert tight.zero is not None
    assert tight.zero.force == pytest.approx([0.37 + 5.2], abs=4e-3)
    check_tension(tight)
    with pytest.raises(StoppedError, match=r"was measured as 3 N, where limits\.start allows 0\.5 N"):
        check_tension(tensioned(slack, at_rest(force=3.0)))
    check_tension(RIG)


def test_a_hand_is_led_to_the_pretension() -> None:
    spec, said = apply(RIG, {"actuator.pretension": [5.0]}), []
    pulls = iter([0.0, 3.0, 5.6, 5.1, 5.1, 5.1, 5.1])
    why = approach(spec, lambda: at_rest(force=next(pulls)), said.append, lambda: False)
    assert why == ""
    assert [words.rpartition(", ")[2] for words in said] == ["tighten", "tighten", "loosen", "right"]


def test_a_hand_that_goes_too_far_or_takes_too_long_is_told() -> None:
    spec = apply(RIG, {"actuator.pretension": [5.0]})
    beyond = approach(spec, lambda: at_rest(force=51.0), lambda words: None, lambda: False)
    assert beyond == "The wire of a1 pulls 51 N, but may pull 50 N; let go."
    late = approach(spec, lambda: at_rest(force=2.0), lambda words: None, lambda: True)
    assert "was not reached in time (a1: 2 N of 5 +- 0.25 N, tighten)" in late


def test_wires_are_tightened_from_a_zero_with_slack_ones() -> None:
    with pytest.raises(InputError, match=r"actuator\.pretension is 0"):
        slack_zero(RIG)
    wanted = apply(RIG, {"actuator.pretension": [5.0]})
    with pytest.raises(InputError, match=r"zero\.force is missing"):
        slack_zero(wanted)
    slack = zeroed(wanted, at_rest(), ALL)
    again = slack_zero(tensioned(slack, at_rest(force=5.0)))
    assert again.zero is not None and slack.zero is not None
    assert again.zero.force == pytest.approx(slack.zero.force, abs=1e-12)


def test_a_zero_of_another_size_is_refused() -> None:
    with pytest.raises(InputError, match=r"zero\.force"):
        apply(RIG, {"zero.force": [1.0, 2.0]})
