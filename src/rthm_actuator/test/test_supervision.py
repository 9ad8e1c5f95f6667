from __future__ import annotations

import math

import numpy as np
import pytest

from rthm_actuator.arming import differences, expected_start
from rthm_actuator.overdue import Hold, Pulse
from rthm_actuator.sensors import FORCE, MOTOR, POSITION, VELOCITY, Channel, Sensors
from rthm_actuator.supervision import Broken, Following, Frozen, Largest, Step, not_finite
from rthm_actuator.watch import Watch
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.limits import kept_limits, require_limits
from rthm_core.ros.messages import JointSample
from rthm_core.spec import LimitsSpec, Spec, shipped_spec

MS = 1_000_000
CHANNELS = [Channel(POSITION, "x1"), Channel(VELOCITY, "x1"), Channel(MOTOR, "a1"), Channel(FORCE, "a1")]
ALL = {"command": 1.0, "rate": 5.0, "force": 50.0, "stale": 0.05, "ramp": 0.5}


def spec(**limits: object) -> Spec:
    return shipped_spec().model_copy(update={"limits": LimitsSpec(**limits)})


def sample(stamp: int, values: tuple[float, float, float, float]) -> JointSample:
    x, v, u, f = values
    return JointSample(stamp, [x, u], [v, math.nan], [math.nan, f])


@pytest.mark.parametrize(("value", "reading"), [(math.nan, "not a number"), (-math.inf, "infinity")])
def test_a_sensor_that_gives_no_number_is_named(value: float, reading: str) -> None:
    broken = not_finite(CHANNELS, [0.1, 0.0, 0.2, value], 3_008_000_000)
    assert broken is not None
    assert broken.words == f"the force sensor of a1 reads {reading} since 3.008 s"
    assert broken.bad == (FORCE,)
    assert not_finite(CHANNELS, [0.1, 0.0, 0.2, 0.3], 0) is None


def test_a_step_between_two_samples_is_judged_by_the_time_between_them() -> None:
    step = Step(CHANNELS, 0.01, MS)
    assert step.look(0, [0.0, 0.0, 0.0, 0.0]) is None
    assert step.look(MS, [0.009, 9.0, -0.009, 99.0]) is None
    assert step.look(5 * MS, [0.045, 0.0, 0.0, 0.0]) is None
    assert step.look(4 * MS, [9.0, 0.0, 0.0, 0.0]) is None  # overtaken
    broken = step.look(6 * MS, [0.345, 0.0, 0.0, 0.0])
    assert broken is not None
    assert broken.value == pytest.approx(0.3)
    assert broken.allowed == 0.01
    assert "position sensor of x1 steps by 0.3 m" in broken.words


def test_a_motor_may_go_at_once_as_far_as_commands_step_and_the_plant_may_not() -> None:
    step = Step(CHANNELS, 0.01, MS, commands=4 * MS)
    assert step.look(0, [0.0, 0.0, 0.0, 0.0]) is None
    assert step.look(MS, [0.009, 0.0, 0.039, 0.0]) is None
    broken = step.look(2 * MS, [0.009, 0.0, 0.08, 0.0])
    assert broken is not None
    assert broken.allowed == pytest.approx(0.04)
    assert "motor position sensor of a1" in broken.words


def test_one_frozen_sensor_is_found_while_the_others_change() -> None:
    frozen = Frozen(CHANNELS, 250 * MS, 0.01)
    found = None
    for k in range(400):
        moved = 0.001 * k
        values = [0.5, moved, moved, moved]
        found = found or frozen.look(k * MS, values, np.array([moved]))
    assert found is not None
    assert found.limit == "frozen"
    assert found.value == pytest.approx(0.251)
    assert found.bad == (POSITION,)


def test_a_sensor_may_stand_while_the_command_stands_or_trembles() -> None:
    frozen = Frozen(CHANNELS, 250 * MS, 0.01)
    for k in range(2000):
        command = np.array([0.5 + 1e-4 * math.sin(k)])
        assert frozen.look(k * MS, [0.5, 0.0, 0.5, 0.0], command) is None


def test_samples_that_come_late_say_nothing_of_commands_that_they_did_not_see() -> None:
    frozen = Frozen(CHANNELS, 250 * MS, 0.01)
    for k in range(1000):
        assert frozen.look(k * MS, [0.5, 0.0, 0.5, 0.0], np.array([0.5]), late=(1000 - k) * MS) is None
        if k < 800:  # the last ones come in time, and have seen the first commands
            assert frozen.look(k * MS, [0.5, 0.0, 0.5, 0.0], np.array([0.6]), late=(1000 - k) * MS) is None
    assert any(frozen.look((1000 + k) * MS, [0.5, 0.0, 0.5, 0.0], np.array([0.7])) for k in range(251))


def test_measured_positions_velocities_and_forces_have_limits_of_their_own() -> None:
    largest = Largest(CHANNELS, {"position": 0.6, "velocity": None, "measured_force": 20.0})
    assert largest.look([0.6, 99.0, 9.0, -20.0]) is None
    broken = largest.look([0.5, 0.0, 0.0, -20.1])
    assert broken == Broken(
        "measured_force", 20.1, 20.0, "the force sensor of a1 reads -20.1 N, allowed is 20 N"
    )


def test_a_motor_that_does_not_follow_is_told() -> None:
    following = Following(["a1", "a2"], 0.05)
    assert following.look([0.1, 0.2], np.array([0.14, 0.16])) is None
    broken = following.look([0.1, 0.2], np.array([0.1, 0.3]))
    assert broken is not None
    assert broken.words.startswith("the motor of a2 is 0.1 m off")


def test_time_at_a_limit_counts_only_while_it_lasts() -> None:
    hold = Hold(500 * MS)
    assert all(hold.look(k * MS, ["rate"] if k % 400 else []) is None for k in range(2000))
    assert hold.look(2500 * MS, ["rate"]) is not None


def test_a_heartbeat_counts_from_its_first_beat_or_from_the_start() -> None:
    pulse, awaited = Pulse(200 * MS), Pulse(200 * MS, awaited=True)
    assert pulse.look(10 * NS) is None
    assert awaited.look(201 * MS) is not None
    pulse.beat(10 * NS, well=True)
    assert pulse.look(10 * NS + 200 * MS) is None
    assert pulse.look(10 * NS + 201 * MS) is not None
    pulse.beat(11 * NS, well=False)
    broken = pulse.look(11 * NS)
    assert broken is not None
    assert broken.value is None


def test_the_start_of_the_paper_is_where_its_wire_pulls_with_three_newton() -> None:
    start = expected_start(shipped_spec())
    assert start[Channel(POSITION, "x1")] == 0.5
    assert start[Channel(MOTOR, "a1")] == pytest.approx(0.425)
    assert start[Channel(FORCE, "a1")] == pytest.approx(-3.0)


def test_a_rig_elsewhere_is_refused_with_both_figures_the_worst_first() -> None:
    assert differences(shipped_spec(), [0.505, 9.0, 0.43, -3.4], (0.01, 0.5)) == []
    away = differences(shipped_spec(), [0.1, 0.0, 0.1, 0.0], (0.01, 0.5))
    assert [one.channel.kind for one in away] == [POSITION, MOTOR, FORCE]
    assert "reads 0.1 m and the spec begins at 0.5 m, 0.4 m away" in away[0].words
    lost = differences(shipped_spec(), [0.5, 0.0, 0.425, math.nan], (0.01, 0.5))
    assert lost[0].words == "the force sensor of a1 reads nan"


def test_beside_a_real_machine_no_limit_that_has_a_default_is_off() -> None:
    kept = kept_limits(spec(**ALL), hardware=True)
    assert kept.start == (0.01, 0.5)
    assert kept.step == pytest.approx(2 * 5.0 * 0.0012)
    assert (kept.frozen, kept.hold, kept.age, kept.command_age) == (0.25, 0.5, 0.05, 0.05)
    assert kept.heartbeat == 0.2
    simulated = kept_limits(shipped_spec(), hardware=False)
    assert simulated.model_dump(exclude={"heartbeat"}) == LimitsSpec().model_dump(exclude={"heartbeat"})
    assert kept_limits(spec(**ALL, step=0.5), hardware=True).step == 0.5


@pytest.mark.parametrize("missing", list(ALL))
def test_a_real_machine_needs_its_limits(missing: str) -> None:
    given = {name: value for name, value in ALL.items() if name != missing}
    with pytest.raises(InputError, match=rf"limits.{missing} is missing"):
        require_limits(spec(**given))
    with pytest.raises(InputError, match=r"limits\.command, rate, force, stale and ramp are missing"):
        require_limits(shipped_spec())


def test_a_velocity_that_nobody_needs_may_be_missing() -> None:
    needs = Sensors(shipped_spec())
    assert needs.needed(Channel(VELOCITY, "x1"))
    paper = shipped_spec()
    assert paper.interface is not None
    bare = paper.model_copy(update={"interface": paper.interface.model_copy(update={"damping": (0.0,)})})
    watch = Watch(bare, kept_limits(bare, hardware=False), hardware=True)
    assert watch.see(sample(0, (0.5, math.nan, 0.425, -3.0)), np.array([0.425])) is None
    x1, v1 = watch.interface(sample(0, (0.5, math.nan, 0.425, -3.0)))
    assert (x1.tolist(), v1.tolist()) == ([0.5], [0.0])


def test_a_watch_looks_at_all_limits_of_a_real_machine() -> None:
    test = spec(**ALL)
    watch = Watch(test, kept_limits(test, hardware=True), hardware=True)
    at_rest, command = (0.5, 0.0, 0.425, -3.0), np.array([0.425])
    assert watch.see(sample(0, at_rest), command) is None
    assert watch.unloaded == pytest.approx([0.5])
    broken = watch.see(sample(1_200_000, (0.8, 0.0, 0.425, -3.0)), command)
    assert broken is not None
    assert broken.limit == "step"
    broken = watch.see(sample(2_400_000, (0.8, 0.0, math.nan, -3.0)), command)
    assert broken is not None
    assert broken.limit == "finite"
