"""The replay of plant, wire and motor is the simulator's physics, on steps of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.criteria.replay import BUDGET_STEPS, KINK_STEP_S
from rthm_analysis.diagnosis.physical.drives import choose_drives
from rthm_analysis.diagnosis.replay.budget import budget_for
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.mechanics import mechanics
from rthm_analysis.diagnosis.replay.motor import held_motion
from rthm_analysis.diagnosis.replay.resolution import steps_in
from rthm_analysis.diagnosis.replay.windows import state_at, windows
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec, apply, shipped_spec

from .side import COMMANDS, DUE, EVIDENCE, PAPER, STAMPS, having, simulated

FAR_BELOW_NOISE = np.array([3e-6, 1.5e-4, 1.5e-3, 1e-6])
"""Of position, velocity, force and motor; reference noise is 1e-4 m, 2e-3 m/s, 0.02 N and 1e-5 m."""


def replayed(spec: Spec) -> np.ndarray:
    return Experiment(EVIDENCE, first_command(PAPER)).predicted(spec, windows(EVIDENCE, PAPER, True))


SPECS = [
    PAPER,
    having("plant", "coulomb_friction", force=0.3),
    having("plant", "stribeck_friction", coulomb_force=0.2, static_force=0.4, stribeck_velocity=0.05),
    having("plant", "bouc_wen", alpha=5.0, A=1.0, beta=5.0, gamma=5.0, n=1.0),
    having("plant", "end_stop", position=0.3, stiffness=200.0, damping=1.0),
    having("plant", "clearance", gap=0.3, stiffness=20.0),
    having("plant", "hidden_mode", mass=0.05, frequency=8.0, damping_ratio=0.05),
    having("plant", "harmonic_load", amplitude=0.3, frequency=5.0, phase=0.3),
    having("wire", "backlash", gap=0.01),
    having("wire", "slack", pretension=0.5),
    having("wire", "pulley_inertia", mass=0.01, damping=0.1),
    having("wire", "pulley_friction", force=0.3),
    having("wire", "maxwell_branch", poles=True, stiffness=5.0, damping=2.0),
    having("wire", "pulley_inertia", poles=True, mass=0.002, damping=0.05),
    having("motor", "lag", poles=True, time_constant=0.003),
    having("motor", "second_order", frequency=100.0, damping_ratio=0.5),
    having("motor", "rate_limit", rate=0.5),
    having("motor", "rate_limit", poles=True, rate=0.85),
    having("motor", "quantisation", step=0.004),
    having("sensor.position", "lag", time_constant=0.003),
    having("sensor.velocity", "lag", time_constant=0.01),
    having("sensor.force", "lag", time_constant=0.006),
    having("sensor.force", "lag", poles=True, time_constant=0.002),
    having("sensor.velocity", "scale", scale=1.05),
]


@pytest.mark.parametrize(
    "spec", SPECS, ids=[f"{s.effects[0].block}-{s.effects[0].kind}" if s.effects else "plain" for s in SPECS]
)
def test_replay_agrees_with_the_simulator_far_below_the_noise(spec: Spec) -> None:
    assert np.all(np.abs(replayed(spec) - simulated(spec)).max(0) < FAR_BELOW_NOISE)


@pytest.mark.parametrize(
    "changes",
    [
        {"actuator.pretension": [1.0]},
        {
            "effects": ["one"],
            "one": {"block": "wire", "kind": "hardening", "actuator": "a1"} | {"coefficient": 300.0},
        },
    ],
    ids=["slack", "hardening"],
)
def test_the_force_of_a_wire_that_is_not_linear_behind_a_pulley_that_moves(changes: dict) -> None:
    spec = apply(shipped_spec("transmission"), changes)
    experiment = Experiment(EVIDENCE, first_command(spec))
    seen = experiment.predicted(spec, windows(EVIDENCE, spec, True))
    assert np.all(np.abs(seen - simulated(spec)).max(0) < FAR_BELOW_NOISE)


REMEMBERING = [
    having("wire", "bouc_wen", poles=True, alpha=8.0, A=1.0, beta=30.0, gamma=30.0, n=1.0),
    having("wire", "backlash", poles=True, gap=0.01),
    having("wire", "pulley_friction", poles=True, force=0.3),
]


@pytest.mark.parametrize("spec", REMEMBERING, ids=[s.effects[0].kind for s in REMEMBERING])
def test_a_wire_that_remembers_its_path_needs_a_fine_grid_behind_a_slow_motor(spec: Spec) -> None:
    experiment, runs, true = (
        Experiment(EVIDENCE, first_command(PAPER)),
        windows(EVIDENCE, PAPER, True),
        simulated(spec),
    )
    assert experiment.sharpen(spec)
    assert not experiment.sharpen(spec)
    sharp = np.abs(experiment.predicted(spec, runs) - true).max(0)
    assert np.all(sharp < 5.0 * FAR_BELOW_NOISE)


def test_wires_that_do_not_remember_their_path_need_no_finer_grid() -> None:
    spec = having("wire", "maxwell_branch", poles=True, stiffness=5.0, damping=2.0)
    assert not Experiment(EVIDENCE, first_command(PAPER)).sharpen(spec)
    assert not Experiment(EVIDENCE, first_command(PAPER)).sharpen(having("wire", "backlash", gap=0.01))


def test_a_delay_between_two_samples_is_left_to_the_plant() -> None:
    def measured(delay: float) -> np.ndarray:
        row = np.searchsorted(DUE + round(delay * 1e9), STAMPS, side="right") - 1
        return np.where(row[:, None] < 0, first_command(PAPER), COMMANDS[row])

    true, noise = measured(0.00307), np.random.default_rng(1).normal(0.0, 1e-5, (STAMPS.size, 1))
    motors = replace(EVIDENCE.only("motor"), measured=true + noise)
    alike = [d for d in np.arange(0.0028, 0.0034, 2e-5) if np.array_equal(measured(d), true)]
    found = choose_drives(motors, PAPER, first_command(PAPER)).model.parameters[0]
    assert found.key == "drive1.delay"
    assert found.low <= alike[0] + 1e-6 and found.high >= alike[-1] - 1e-6
    assert found.high - found.low < alike[-1] - alike[0] + 4e-5


def test_before_the_first_command_wires_and_motors_count_as_not_measured() -> None:
    kept = np.isfinite(EVIDENCE.under_command().measured)
    assert kept[:, :2].all() and not kept[:9, 2:].any() and kept[9:, 2:].all()
    late = replace(EVIDENCE, due_ns=DUE + 1_000_000_000)
    assert late.under_command() is late


def test_a_longer_recording_may_take_more_work_up_to_four_times() -> None:
    shares = [budget_for(samples).limit / BUDGET_STEPS for samples in (3_000, 50_000, 75_000, 600_000)]
    assert shares == [1.0, 1.0, 1.5, 4.0]


@pytest.mark.parametrize(
    "kind", [{}, {"kind": "quantisation", "step": 0.004}, {"kind": "extra_delay", "delay": 0.003}]
)
def test_motors_that_follow_at_once_are_where_they_are_on_a_grid(kind: dict) -> None:
    motors = EVIDENCE.only("motor")
    spec = having("motor", **kind) if kind else PAPER
    alone = Experiment(motors, first_command(spec))
    inputs = alone._inputs(spec)
    assert np.array_equal(
        alone.motion(spec, windows(EVIDENCE, PAPER, True)).motor, inputs.course[inputs.samples, 0]
    )
    slow = having("motor", "rate_limit", rate=0.5)
    assert held_motion(slow, motors.stamps_ns, motors.due_ns, motors.commands, alone.first) is None


def test_an_interval_takes_as_many_steps_as_it_is_long() -> None:
    spec = having("wire", "backlash", gap=0.01)
    time = np.cumsum([0.0, 0.004, 0.0005, 0.005, 0.002])
    steps = steps_in(time, spec, mechanics(spec), 1.0, coarse=False)
    assert steps.tolist() == [2, 1, 3, 1, 1]
    assert np.all(np.diff(time) / steps[:-1] <= KINK_STEP_S)


def test_what_a_law_does_is_not_lost_in_the_replay() -> None:
    difference = np.abs(replayed(having("plant", "coulomb_friction", force=0.3)) - replayed(PAPER)).max(0)
    assert difference[0] > 1e-3 and difference[2] > 0.05


@pytest.mark.parametrize("sample", [0, 60, 119])
def test_a_state_is_estimated_from_few_samples_of_a_period_and_at_the_ends(sample: int) -> None:
    at = 2.0 * np.pi / 24.0 * np.arange(120)
    motion = np.stack([np.cos(at), -np.sin(at)], axis=1)
    stamps = np.rint(1e9 * at).astype(np.int64)
    channels = (Channel("position", "x1"), Channel("velocity", "x1"))
    nothing = np.empty((0, 1))
    seen = Evidence(stamps, stamps[:0], nothing, np.zeros((120, 1)), channels, motion, "force")
    np.testing.assert_allclose(state_at(seen, PAPER, sample), motion[sample], atol=0.03)
