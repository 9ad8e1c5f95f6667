"""The diagnosis's replay of the physical side is the engine's motion, for every kind of effect."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from every_kind import LOOP, SIZES, having, named, places

from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.motor import motor_delay
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.energy.model import load_at
from rthm_core.effects import effect
from rthm_core.engine import simulate
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec, apply

from . import side
from .side import CHANNELS, COMMANDS, DUE, EVIDENCE, PAPER

NOISE = np.array([1e-4, 2e-3, 0.02, 1e-5])
"""Reference noise of position, velocity, force and motor."""

EXACT, AS_SEARCHED = 1e-3, 0.02
"""Largest difference over the noise: in fine steps, and in those that a search takes."""

MOTORS = {"at once": {}, "slow": {"actuator.motor_poles": [400.0, 2000.0]}}
FINE = {"at once": 50_000, "slow": 5_000}
"""Steps of the replay, ns, where its own accuracy is not asked for: it places no turn of a wire in them."""

STAMPS = EVIDENCE.stamps_ns[:600]

ONE_RUN = Windows(np.zeros(1, dtype=np.int64), np.array([[PAPER.plant.initial_position[0], 0.0]]), None)
"""From the start of a test on."""


def told(step: int | None) -> tuple[np.ndarray, np.ndarray]:
    """Instants and commands; each is told again every `step` ns, which moves nothing and refines the grid."""
    if step is None:
        return DUE, COMMANDS
    due = np.arange(0, STAMPS[-1], step)
    return due, np.vstack([first_command(PAPER), COMMANDS])[np.searchsorted(DUE, due, side="right")]


def replayed(spec: Spec, step: int | None) -> np.ndarray:
    due, commands = told(step)
    nothing = np.zeros((STAMPS.size, 1)), np.zeros((STAMPS.size, 4))
    evidence: Evidence = replace(
        EVIDENCE, stamps_ns=STAMPS, due_ns=due, commands=commands, load=nothing[0], measured=nothing[1]
    )
    return Experiment(evidence, first_command(PAPER)).predicted(spec, ONE_RUN)


def simulated(spec: Spec, step: int | None) -> np.ndarray:
    """What the simulator's data acquisition sees; no step of its own ends where a wire's force bends."""
    bends = any(one.block == "wire" and one.law.kinked for one in spec.effects)
    due, commands = told(step if bends else None)
    return side.simulated(spec, commands, due + motor_delay(spec), STAMPS)


def allowed(spec: Spec, share: float) -> np.ndarray:
    """Largest difference of each channel; a replay knows what a sensor saw before it rounded."""
    half_a_step, channels = np.zeros(NOISE.size), ("position", "velocity", "force")
    for one in spec.effects:
        sensor = one.block.partition(".")[2]
        if sensor in channels and one.law.changes == "step":
            half_a_step[channels.index(sensor)] = 0.5 * one.numbers["step"]
    return share * NOISE + half_a_step


def check(
    place: tuple[str, str], size: str, motor: str, share: float, step: int | None, seed: int = 5
) -> None:
    spec = having(apply(PAPER, MOTORS[motor]), *place, size, seed)
    apart = np.abs(replayed(spec, step) - simulated(spec, step)).max(axis=0)
    assert np.all(apart <= allowed(spec, share)), (size, seed, apart / NOISE)


WITHOUT = ("numerical", "interface", "actuator", "timing", "load.numerical")
ALONE = dict.fromkeys(WITHOUT) | {"plant.damping": 0.3}

PHYSICAL = places("plant", "wire", "motor", "sensor")


@pytest.mark.parametrize("place", PHYSICAL, ids=named)
def test_replay_is_the_engine_to_a_thousandth_of_the_noise(place: tuple[str, str]) -> None:
    for size in SIZES:
        check(place, size, "at once", EXACT, FINE["at once"])


@pytest.mark.parametrize("place", places("plant", "wire", "motor"), ids=named)
def test_replay_is_the_engine_behind_a_slow_motor(place: tuple[str, str]) -> None:
    check(place, "middling", "slow", EXACT, FINE["slow"])


@pytest.mark.parametrize("place", PHYSICAL, ids=named)
def test_the_steps_of_a_search_are_far_below_the_noise(place: tuple[str, str]) -> None:
    check(place, "dominating", "at once", AS_SEARCHED, None)


@pytest.mark.parametrize("kind", [kind for _, kind in places("plant")])
def test_a_plant_alone_is_replayed_from_known_forces_at_its_samples(kind: str) -> None:
    sticks = effect(kind, "plant").jump
    spec = apply(having(LOOP, "plant", kind, "dominating" if sticks else "middling"), ALONE)
    run = simulate(spec, 8.0, 0.005, energies=False)
    true, stamps = np.hstack([run.plant_position, run.plant_velocity]), np.arange(run.t.size) * 5_000_000
    nothing, load = np.empty((0, 0)), load_at(spec, stamps)
    evidence = Evidence(stamps, stamps[:0], nothing, load, CHANNELS[:2], true, "force")
    apart = np.abs(Experiment(evidence, np.empty(0)).predicted(spec, ONE_RUN.at(true[:1])) - true)
    assert np.all(apart.max(axis=0) < AS_SEARCHED * NOISE[:2]), apart.max(axis=0) / NOISE[:2]


@pytest.mark.long
@pytest.mark.parametrize("place", PHYSICAL, ids=named)
@pytest.mark.parametrize("motor", MOTORS)
def test_replay_is_the_engine_at_many_amounts(place: tuple[str, str], motor: str) -> None:
    for seed in range(10):
        for size in SIZES:
            check(place, size, motor, EXACT, FINE[motor], seed)
