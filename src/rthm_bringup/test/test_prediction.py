"""What is predicted of a test is what the engine says; a test beyond its limits is refused with figures."""

from __future__ import annotations

import re

import numpy as np
import pytest

from rthm_bringup.run.prediction import UNITS, Prediction, predicted
from rthm_core.engine import simulate
from rthm_core.spec import LimitsSpec, Spec, apply, scaled_motion, shipped_spec

PAPER = shipped_spec()
SECONDS = 15.0
"""More than one stretch."""


def limited(**limits: float) -> Spec:
    return PAPER.model_copy(update={"limits": LimitsSpec(**limits)})


@pytest.fixture(scope="module")
def values() -> dict[str, float]:
    return dict(predicted(PAPER, SECONDS).values)


def test_the_largest_values_are_those_of_the_engine(values: dict[str, float]) -> None:
    period = PAPER.loop().timing.td3
    exact = simulate(PAPER, SECONDS, period, energies=False)
    u = exact.plant_position + exact.actuator_force / 40.0
    assert set(values) == set(UNITS)
    assert values["position"] == pytest.approx(np.abs(exact.plant_position).max(), rel=1e-12)
    assert values["measured_force"] == pytest.approx(np.abs(exact.actuator_force).max(), rel=1e-12)
    assert values["command"] == pytest.approx(np.abs(u).max(), rel=1e-12)
    assert values["rate"] == pytest.approx(np.abs(np.diff(u, axis=0)).max() / period, rel=1e-9)


def test_limits_that_the_test_stays_within_are_told_in_one_line_with_both_figures() -> None:
    prediction = predicted(limited(command=1.0, force=50.0), SECONDS)
    assert prediction.refusal == ""
    assert prediction.words == "predicted for 15 s: command 0.425 of 1 m, force 3.25 of 50 N"
    assert prediction.as_dict()["force"]["allowed"] == 50.0


@pytest.mark.parametrize("name", sorted(UNITS))
def test_each_limit_that_the_test_goes_beyond_refuses_it(name: str, values: dict[str, float]) -> None:
    assert predicted(limited(**{name: 1.001 * values[name]}), SECONDS).refusal == ""
    refusal = predicted(limited(**{name: 0.999 * values[name]}), SECONDS).refusal
    assert refusal.startswith(f"Nothing was moved, as the test is predicted to go beyond its limits: {name} ")
    assert UNITS[name] in refusal


def test_the_amplitude_that_a_refusal_names_is_within_the_limits() -> None:
    spec = limited(rate=0.7, position=0.3)
    refusal = predicted(spec, SECONDS).refusal
    named = re.search(r"--amplitude ([0-9.]+),", refusal)
    assert named, refusal
    assert predicted(scaled_motion(spec, float(named[1])), SECONDS).refusal == ""


def test_an_unstable_test_is_refused() -> None:
    unstable = apply(limited(position=2.0), {"timing.tau3": 0.3})
    assert "position" in predicted(unstable, 60.0).refusal


def test_a_test_without_end_is_predicted_as_far_as_the_time_goes() -> None:
    prediction = predicted(limited(command=1.0), 0.0, budget=0.0)
    assert 0.0 < prediction.seconds < 600.0
    assert prediction.words.startswith(f"predicted for {prediction.seconds:g} s: command")


def test_what_cannot_be_predicted_is_told_and_refuses_nothing() -> None:
    prediction = Prediction({}, LimitsSpec(command=0.1), why="no engine fits.")
    assert prediction.refusal == ""
    assert "so its limits were not checked beforehand: no engine fits." in prediction.words
