"""A delay shorter than its tau is the loop with the shorter tau; nothing arrives before it was sent."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.link import Link
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec, apply, shipped_spec

PLACES = [("tau1", "link.tau1"), ("tau2", "link.tau2"), ("tau3", "link.tau3"), ("tau4", "link.tau4")]


def early(spec: Spec, block: str, delay: float) -> Spec:
    section: dict[str, Any] = {"block": block, "kind": "extra_delay", "delay": delay}
    if block == "motor":
        section["actuator"] = "a1"
    return apply(spec, {"effects": ["early"], "early": section})


@pytest.mark.parametrize(("name", "block"), [*PLACES, ("tau4", "motor")])
def test_a_longer_tau_with_a_negative_delay_is_the_shorter_tau(name, block):
    spec = shipped_spec("paper")
    tau = getattr(spec.loop().timing, name)
    same = early(apply(spec, {f"timing.{name}": tau + 0.002}), block, -0.002)
    runs = [simulate(one, 3.0, 0.01) for one in (spec, same)]
    for field in ("plant_position", "plant_velocity", "numerical_position", "actuator_force"):
        expected, found = (getattr(run, field) for run in runs)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize("block", ["link.tau4", "motor"])
def test_commands_arrive_by_as_much_earlier(block):
    spec = apply(shipped_spec("paper"), {"timing.tau4": 0.012})
    whole, less = Schedule(spec), Schedule(early(spec, block, -0.002))
    due, commands = whole.arrivals(100_000_000, 300_000_000)
    earlier, same = less.arrivals(98_000_000, 298_000_000)
    np.testing.assert_array_equal(earlier, due - 2_000_000)
    np.testing.assert_array_equal(same.time, commands.time)


def test_a_delay_can_be_taken_off_altogether():
    spec = early(shipped_spec("paper"), "link.tau1", -0.004)
    assert Link(spec, "tau1").delay_ns == 0


@pytest.mark.parametrize(("block", "tau"), [("link.tau1", "tau1"), ("motor", "tau4")])
def test_nothing_arrives_before_it_was_sent(block, tau):
    with pytest.raises(InputError, match=rf"early\.delay is -0\.02, .* at least .*, as timing\.{tau} leave"):
        early(shipped_spec("paper"), block, -0.02)


def test_motor_and_link_share_one_tau4():
    spec = early(shipped_spec("paper"), "link.tau4", -0.006)
    both = {"effects": ["early", "eager"]}
    eager = {"block": "motor", "kind": "extra_delay", "actuator": "a1", "delay": -0.003}
    assert Schedule(apply(spec, both | {"eager": eager})).motor_delay == -3_000_000
    with pytest.raises(InputError, match=r"eager\.delay is -0\.005, .* at least -0\.004 s"):
        apply(spec, both | {"eager": eager | {"delay": -0.005}})


def test_clocks_that_differ_leave_a_fast_motor_no_time_before_the_command():
    offset = {"block": "link.tau4", "kind": "clock_offset", "offset": -0.009}
    spec = early(shipped_spec("paper"), "motor", -0.003)
    both = apply(spec, {"effects": ["early", "clocks"], "clocks": offset})
    due, commands = Schedule(both).arrivals(0, 100_000_000)
    assert (due >= commands.time).all()
