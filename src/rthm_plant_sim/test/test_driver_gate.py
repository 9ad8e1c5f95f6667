"""What a driver executes, and what it makes of a reading."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rthm_core.errors import InputError
from rthm_core.limits import kept_limits
from rthm_core.spec import LimitsSpec, apply, shipped_spec
from rthm_plant_sim.driver.device import Layout, Reading
from rthm_plant_sim.driver.gate import Gate
from rthm_plant_sim.driver.telling import Teller

MS = 1_000_000
LIMITS = LimitsSpec(command=1.0, rate=5.0, force=50.0, stale=0.05, ramp=0.5)
SPEC = shipped_spec().model_copy(update={"limits": LIMITS})


def gate(motor: float | None = 0.4) -> Gate:
    made = Gate(kept_limits(SPEC, hardware=True), 4 * MS)
    made.motor = None if motor is None else np.array([motor])
    return made


def at(milliseconds: int, value: float, through: Gate, age: int = 10, owners: int = 1) -> float | None:
    executed = through.executed((milliseconds - age) * MS, milliseconds * MS, np.array([value]), owners)
    return None if executed is None else float(executed[0])


def test_nothing_moves_before_a_command_begins_where_the_motor_stands() -> None:
    made = gate()
    assert at(100, 0.42, made) is None
    assert not made.armed
    assert made.refused["start"] == 1
    assert made.why(np.array([0.42]), 1) == (
        "not armed: the motors are commanded to [0.42] m and stand at [0.4] m; limits.start allows 0.01 m,"
        " and limits.command_age 0.05 s"
    )
    assert at(104, 0.405, made) == 0.405
    assert made.armed


@pytest.mark.parametrize("motor", [None, math.nan])
def test_a_motor_that_is_not_measured_is_not_armed(motor: float | None) -> None:
    made = gate(motor)
    assert at(100, 0.4, made) is None
    assert not made.armed


@pytest.mark.parametrize(("value", "age", "limit"), [(0.4, 51, "command_age"), (math.nan, 10, "finite")])
def test_a_command_that_is_not_executed_arms_nothing(value: float, age: int, limit: str) -> None:
    made = gate()
    assert at(100, value, made, age) is None
    assert not made.armed
    assert made.refused[limit] == 1


def test_after_a_silence_the_motors_hold_until_a_command_begins_where_they_stand() -> None:
    made = gate()
    assert at(100, 0.4, made) == 0.4
    assert made.silent(150 * MS) is None
    assert made.silent(151 * MS) == pytest.approx(0.051)
    assert not made.armed
    assert made.silent(200 * MS) is None
    assert at(204, 0.45, made) is None
    made.motor = np.array([0.45])
    assert at(208, 0.45, made) == 0.45


def test_armed_motors_move_within_their_rate() -> None:
    made, u = gate(), 0.4
    for k in range(25):
        moved = at(100 + 4 * k, 0.4 if k == 0 else 0.6, made)
        assert moved is not None
        assert moved - u <= 5.0 * 0.004 + 1e-12
        u = moved
    assert u == pytest.approx(0.6)


def test_with_two_who_command_nobody_is_obeyed() -> None:
    made = gate()
    assert at(100, 0.4, made) == 0.4
    assert at(104, 0.4, made, owners=2) is None
    assert not made.armed
    assert made.refused["owner"] == 1


def test_a_reading_becomes_the_arrays_of_the_state_in_the_order_of_the_spec() -> None:
    position, velocity, effort = Layout(SPEC).values(Reading(0.1, np.array([0.2]), [0.3], 4.0)).tolist()
    assert position == [0.1, 0.3]
    assert velocity[0] == 0.2
    assert math.isnan(velocity[1])
    assert math.isnan(effort[0])
    assert effort[1] == 4.0


def test_a_reading_of_another_size_is_refused_in_one_sentence() -> None:
    with pytest.raises(InputError, match=r"the motor of a reading has 2 values, but the spec has 1; return"):
        Layout(SPEC).values(Reading(0.1, 0.2, (0.3, 0.4), 4.0))


def test_a_spec_without_the_limits_of_a_machine_is_refused() -> None:
    with pytest.raises(InputError, match=r"limits.rate is missing"):
        kept_limits(apply(SPEC, {"limits.rate": None}), hardware=True)


def test_a_driver_tells_each_thing_once() -> None:
    said: list[str] = []
    teller = Teller(said.append)
    for words in ("armed", "not armed: 0.1 m", "not armed: 0.2 m", "armed"):
        teller.say(words)
    teller.say_of_device("")
    teller.say_of_device("holds")
    teller.say_of_device("holds")
    assert said == ["armed", "not armed: 0.1 m", "armed", "the device: holds"]
