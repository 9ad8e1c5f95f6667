"""A simulated rig with noise is identified from a small motion, with uncertainties that hold."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rthm_analysis.identification import Identified, Motion, identify
from rthm_analysis.identification.motor import response
from rthm_core.clock import NS
from rthm_core.excitation import QUIET_START, excitation
from rthm_core.physical import PhysicalSide
from rthm_core.spec import Spec, apply, read_spec, shipped_spec

TRUE = apply(
    shipped_spec(),
    {
        "actuator.stiffness": 43.0,
        "actuator.motor_poles": [150.0, 700.0],
        "timing.tau4": 0.0113,
        "plant": {"damping": [0.5], "initial_position": [0.0]},
        "noise": {"position": 1e-4, "velocity": 2e-3, "motor": 1e-5, "force": 0.02},
    },
)
CLAIMED = apply(shipped_spec(), {"actuator.motor_poles": [400.0, 2000.0], "plant.initial_position": [0.0]})
SEEDS = range(12)


def moved(true: Spec, travel: float = 0.02, seconds: float = 4.0, dead_time: float | None = None) -> Motion:
    """What a rig does in `seconds` of motion, sampled; its driver tells uses where it has a dead time."""
    timing, side, motion = true.loop().timing, PhysicalSide(true), excitation(true, travel)
    rest = side.sample(0).motor_position.copy()
    end = QUIET_START + seconds
    sent = np.arange(0.0, end, timing.td3)
    commands = np.array([rest + motion.at(float(t)) for t in sent])
    used = sent + timing.tau4
    events = sorted(
        [(t, 0, k) for k, t in enumerate(used) if t < end]
        + [(k * timing.td1, 1, k) for k in range(int(end / timing.td1))]
    )
    rows = []
    for t, kind, k in events:
        at = round(t * NS)
        if kind == 0:
            side.command(at, commands[k])
        elif at > 0:
            one = side.sample(at)
            rows.append([t, one.motor_position[0], one.force[0], one.position[0], one.velocity[0]])
    told = sent if dead_time is None else used - dead_time
    waited = None if dead_time is None else timing.tau4 - dead_time
    return Motion("a1", "x1", *np.array(rows).T, told, commands[:, 0], waited)


def with_seed(seed: int, changes: dict[str, Any] | None = None) -> Spec:
    return apply(TRUE, {"noise.seed": seed} | (changes or {}))


@pytest.fixture(scope="module")
def motions() -> list[Motion]:
    """The same rig with other noise."""
    return [moved(with_seed(seed)) for seed in SEEDS]


def figures(found: Identified) -> dict[str, tuple[float, float]]:
    """Values and standard deviations; of two figures of one name the first."""
    return {one.name: (one.value, one.std) for one in reversed(found.figures)}


def test_true_values_lie_within_the_told_uncertainty(motions: list[Motion]) -> None:
    true = {
        "k_tot of a1": 43.0,
        "delay of the motor of a1": 0.0113,
        "pole of the motor of a1": 150.0,
        "noise of position of x1": 1e-4,
        "noise of velocity of x1": 2e-3,
        "noise of motor of a1": 1e-5,
        "noise of force of a1": 0.02,
    }
    told = [figures(identify([motion], CLAIMED)) for motion in motions]
    for name, value in true.items():
        away = np.array([(one[name][0] - value) / one[name][1] for one in told])
        assert np.abs(away).max() < 3.5, (name, away)
        assert 0.4 < np.sqrt(np.mean(np.square(away))) < 1.6, (name, away)
    assert all(one["k_tot of a1"][1] < 0.2 for one in told)
    assert all(one["delay of the motor of a1"][1] < 1e-4 for one in told)
    assert all(one["pole of the motor of a1"][1] < 2.0 for one in told)


def test_what_was_measured_goes_into_a_spec_with_its_uncertainty(motions: list[Motion]) -> None:
    found = identify(motions[:1], CLAIMED)
    text = found.written(CLAIMED)
    measured = read_spec(text)
    assert measured.k_tot[0] == pytest.approx(43.0, rel=5e-3)
    assert 1e-4 < measured.uncertainty.actuator.stiffness < 5e-3
    assert measured.loop().timing.tau4 == pytest.approx(0.0113, abs=2e-4)
    assert measured.loop().actuator.motor_poles == pytest.approx([150.0, 700.0], rel=0.2)
    assert measured.noise.force == pytest.approx(0.02, rel=0.15)
    assert measured.plant == CLAIMED.plant
    assert text.startswith("# delay of the motor of a1: 0.011")


def test_a_driver_that_keeps_commands_itself_leaves_tau4_as_it_is() -> None:
    found = identify([moved(TRUE, dead_time=0.003)], CLAIMED)
    delay = found.figures[0]
    assert "timing.tau4" not in found.changes
    assert abs(delay.value - 0.0113) < 4.0 * delay.std
    assert "the driver says that it keeps commands for 0.0083 s of it" in delay.line


def test_a_motor_that_is_quicker_than_can_be_seen_has_no_poles() -> None:
    quick = identify([moved(apply(TRUE, {"actuator.motor_poles": None}))], CLAIMED)
    assert quick.changes["actuator.motor_poles"] is None
    assert abs(quick.figures[0].value - 0.0113) < 3.5 * quick.figures[0].std
    assert [one.known for one in quick.figures[1:3]] == [False, False]
    assert "too quick to be seen; it is in the delay" in quick.figures[1].line


def test_what_is_not_measured_is_not_told(motions: list[Motion]) -> None:
    one, nothing = motions[0], np.full(motions[0].time.size, np.nan)
    without_motor = {f.name: f for f in identify([replace(one, motor=nothing)], CLAIMED).figures}
    assert "the position of the motor is not measured" in without_motor["delay of the motor of a1"].line
    assert not without_motor["k_tot of a1"].known
    assert without_motor["noise of force of a1"].known
    without_force = identify([replace(one, force=nothing)], CLAIMED)
    told = {f.name: f for f in without_force.figures}
    assert told["k_tot of a1"].line == "k_tot of a1: not determined, as force were not measured"
    assert told["delay of the motor of a1"].known
    assert "actuator.stiffness" not in without_force.changes
    still = replace(one, command=np.full(one.command.size, one.command[0]))
    assert "nothing was commanded to move" in identify([still], CLAIMED).figures[0].line


@pytest.mark.parametrize(
    ("spoilt", "words"),
    [
        (
            {"force": -1.0},
            "the force has the wrong sign, + has to pull a1's dof along + x; reverse the load cell",
        ),
        ({"position": -1.0, "velocity": -1.0}, "the position of x1 has the wrong sign; correct it"),
        ({"motor": -1.0}, "The motor of a1 moves against its command"),
        ({"motor": -1.0, "command": -1.0}, "the direction of the motor of a1 has the wrong sign"),
        ({"velocity": -1.0}, "The velocity of x1 has the sign of the other direction than its position"),
        ({"motor": 1000.0}, "must move by all of it: the unit of its position or of its command is wrong"),
        ({"position": 0.001, "velocity": 0.001}, "which no spring between the two does"),
        ({"velocity": 0.001}, "one of the two has the wrong unit"),
    ],
)
def test_a_wrong_sign_or_unit_is_one_sentence_and_nothing_is_changed(
    motions: list[Motion], spoilt: dict[str, float], words: str
) -> None:
    changed = {name: factor * getattr(motions[0], name) for name, factor in spoilt.items()}
    found = identify([replace(motions[0], **changed)], CLAIMED)
    assert len(found.wrong) == 1, found.wrong
    assert words in found.wrong[0]
    assert found.changes == {}
    assert found.lines()[-1] == found.wrong[0]


def test_a_held_command_moves_a_motor_of_two_poles_as_its_exact_response() -> None:
    times, command = np.array([0.0, 0.01, 0.02]), np.array([0.0, 1.0, 1.0])
    t = np.array([0.005, 0.0129, 0.014, 0.02, 0.05])
    slow, fast, delay = 0.004, 0.001, 0.003
    since = np.maximum(t - 0.013, 0.0)
    expected = 1.0 - (slow * np.exp(-since / slow) - fast * np.exp(-since / fast)) / (slow - fast)
    np.testing.assert_allclose(response(t, times, command, delay, slow, fast), expected, atol=1e-12)
