"""What many forces do to a linear plant at once is what replays of each say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.noise import white_noise
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.linear import linear_response
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec, spec_from_parameters

from .side import COMMANDS, DUE, PAPER, having

CHANNELS = (
    Channel("position", "x1"),
    Channel("velocity", "x1"),
    Channel("acceleration", "x1"),
    Channel("force", "a1"),
)
RNG = np.random.default_rng(0)
EVEN = np.arange(1700) * 1_200_000
UNEVEN = EVEN + RNG.integers(0, 300_000, EVEN.size)


def evidence(stamps: np.ndarray, measured: np.ndarray, channels: tuple[Channel, ...] = CHANNELS) -> Evidence:
    load = np.zeros((stamps.size, 1))
    return Evidence(stamps - stamps[0], DUE, COMMANDS, load, channels, measured, "command")


def in_runs(*begins: int) -> Windows:
    state = np.zeros((len(begins), 2))
    return Windows(np.array(begins), state, 0.5 if len(begins) > 1 else None)


def regression(spec: Spec, seen: Evidence, runs: Windows) -> Regression:
    noise = white_noise(np.array([1e-4, 2e-3, 0.05, 0.02])[: seen.measured.shape[1]])
    experiment = Experiment(seen, first_command(PAPER), seen.stamps_ns[runs.start])
    return Regression(experiment, runs, noise, Model(spec), seen.time.size)


def both(left: Regression) -> tuple[np.ndarray, np.ndarray]:
    """Responses to eleven forces: many at once, and by replays."""
    time = left.experiment.evidence.time
    shapes = np.stack([np.sin(rate * time) for rate in np.linspace(0.5, 20.0, 11)], axis=1)
    together = left.response(shapes, 0)
    return together, np.stack([left._response(shape, 0) for shape in shapes.T])


@pytest.mark.parametrize("stamps", [EVEN, UNEVEN])
@pytest.mark.parametrize("begins", [(0,), (0, 500, 1100)])
def test_responses_are_those_of_replays(stamps: np.ndarray, begins: tuple[int, ...]) -> None:
    measured = RNG.normal(size=(stamps.size, 4))
    measured[30:60, 2] = np.nan
    left = regression(PAPER, evidence(stamps, measured), in_runs(*begins))
    assert left._linear is not None
    together, alone = both(left)
    assert np.linalg.norm(together - alone) < 1e-3 * np.linalg.norm(alone)


def test_linear_effects_are_part_of_the_plant() -> None:
    spec = having("plant", "maxwell_branch", stiffness=300.0, damping=4.0)
    left = regression(spec, evidence(EVEN, RNG.normal(size=(EVEN.size, 4))), in_runs(0))
    assert left._linear is not None
    together, alone = both(left)
    assert np.linalg.norm(together - alone) < 1e-3 * np.linalg.norm(alone)


@pytest.mark.parametrize(
    "spec",
    [
        having("plant", "cubic_stiffness", coefficient=5.0),
        having("wire", "backlash", gap=1e-3),
        having("sensor.position", "lag", time_constant=0.01),
    ],
)
def test_what_bends_or_reads_wrong_is_replayed(spec: Spec) -> None:
    seen = evidence(EVEN, np.zeros((EVEN.size, 4)))
    assert linear_response(spec, seen, seen, np.array([0])) is None


def test_of_several_dofs_a_force_moves_all() -> None:
    section = {
        "dofs": ["x1", "x2"],
        "mass": [1.0, 0.2, 0.2, 2.0],
        "damping": [0.4, -0.1, -0.1, 0.3],
        "stiffness": [300.0, -80.0, -80.0, 200.0],
        "initial_position": [0.0, 0.0],
        "initial_velocity": [0.0, 0.0],
    }
    spec = spec_from_parameters({"plant": section})
    channels = tuple(Channel(one, dof) for one in ("position", "acceleration") for dof in ("x1", "x2"))
    seen = replace(
        evidence(EVEN, RNG.normal(size=(EVEN.size, 4)), channels),
        load=np.zeros((EVEN.size, 2)), due_ns=DUE[:0], commands=np.empty((0, 0)), driven_by="force",
    )  # fmt: skip
    runs = Windows(np.array([0]), np.zeros((1, 4)), None)
    noise = white_noise(np.array([1e-4, 1e-4, 0.05, 0.05]))
    left = Regression(Experiment(seen, np.empty(0)), runs, noise, Model(spec), seen.time.size)
    assert left._linear is not None
    time = left.experiment.evidence.time
    shapes = np.stack([np.sin(7.0 * time), np.sign(np.sin(3.0 * time))], axis=1)
    for dof in (0, 1):
        alone = np.stack([left._response(shape, dof) for shape in shapes.T])
        assert np.linalg.norm(left.response(shapes, dof) - alone) < 1e-3 * np.linalg.norm(alone)
