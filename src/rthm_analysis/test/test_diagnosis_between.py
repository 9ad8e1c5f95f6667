"""What a load did between its samples is found from the motion that it caused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import cont2discrete

from rthm_analysis.diagnosis.physical.side import diagnose_physical
from rthm_analysis.diagnosis.replay.between import Between, ways
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.spec import Spec, spec_from_parameters

RATE, COUNT = 200.0, 4000
MASS, DAMPING, STIFFNESS = 1.0, 1.0, 400.0
METHODS = {Between.HELD: "zoh", Between.LINEAR: "foh"}


def plant() -> Spec:
    section = {
        "dofs": ["x1"],
        "mass": [MASS],
        "damping": [DAMPING],
        "stiffness": [STIFFNESS],
        "initial_position": [0.0],
        "initial_velocity": [0.0],
    }
    return spec_from_parameters({"plant": section})


def recorded(between: Between, force: np.ndarray, noise: float = 2e-3) -> Evidence:
    """Motion of the plant under a sampled force, exactly, and noise."""
    a = np.array([[0.0, 1.0], [-STIFFNESS / MASS, -DAMPING / MASS]])
    b, c, d = np.array([[0.0], [1.0 / MASS]]), np.eye(2), np.zeros((2, 1))
    phi, gamma, look, through, _ = cont2discrete((a, b, c, d), 1.0 / RATE, METHODS[between])
    motion, state = np.zeros((COUNT, 2)), np.zeros(2)
    for i, value in enumerate(force):
        motion[i] = look @ state + through[:, 0] * value
        state = phi @ state + gamma[:, 0] * value
    motion += np.random.default_rng(1).normal(0.0, noise * motion.std(axis=0), motion.shape)
    stamps = np.arange(COUNT) * round(1e9 / RATE)
    channels = (Channel("position", "x1"), Channel("velocity", "x1"))
    nothing = np.empty(0, dtype=np.int64), np.empty((0, 0))
    return Evidence(stamps, *nothing, force[:, None], channels, motion, "force")


def multisine() -> np.ndarray:
    time, random = np.arange(COUNT) / RATE, np.random.default_rng(2)
    frequencies = np.arange(0.3, 12.0, 0.3)
    waves = np.sin(2.0 * np.pi * frequencies[:, None] * time + random.uniform(0, 2 * np.pi, (39, 1)))
    return np.asarray(waves.sum(axis=0) * np.minimum(time, 1.0))


@pytest.mark.parametrize("between", METHODS)
def test_nothing_is_missing_however_the_load_went_between_its_samples(between: Between) -> None:
    found = diagnose_physical(recorded(between, multisine()), plant(), np.empty(0), lambda said: None)
    assert found.experiment.between is between
    assert not found.selection.rounds
    assert found.fitting.reduced_chi2 < 1.05


def test_a_force_that_nobody_listed_is_found_although_the_load_is_held() -> None:
    evidence = recorded(Between.HELD, multisine())
    pushed = replace(evidence, measured=evidence.measured + np.array([3.0 / STIFFNESS, 0.0]))
    found = diagnose_physical(pushed, plant(), np.empty(0), lambda said: None)
    assert found.experiment.between is Between.HELD
    assert [tried[0].start.added.kind for tried in found.selection.rounds] == ["constant_load"]


def test_a_load_that_is_not_sampled_has_nothing_between_samples() -> None:
    evidence = recorded(Between.HELD, np.zeros(COUNT), noise=0.0)
    assert ways(evidence) == (Between.SMOOTH,)
