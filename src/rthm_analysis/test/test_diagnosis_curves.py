"""Averages of a force over the variable that explains it."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import CURVE_BINS, LIKELY_APART_SAMPLES
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.likely import apart_from_starts
from rthm_analysis.diagnosis.missing.motion import along
from rthm_analysis.diagnosis.missing.sites import site_of
from rthm_analysis.diagnosis.replay.experiment import Motion
from rthm_analysis.diagnosis.replay.windows import Windows

from .plain import NOISE, plant, recorded


def test_averages_bring_a_law_out_of_noise_that_hides_it() -> None:
    random = np.random.default_rng(1)
    v = random.uniform(-1.0, 1.0, 40_000)
    at, mean, std, _ = binned(v, np.tanh(v / 0.2) + random.normal(0.0, 2.0, v.size))
    assert at.size == CURVE_BINS and np.all(np.diff(at) > 0.0)
    np.testing.assert_allclose(std, 2.0 / np.sqrt(v.size / CURVE_BINS), rtol=0.1)
    assert np.abs((mean - np.tanh(at / 0.2)) / std).max() < 4.0


def test_the_variable_that_a_force_depends_on_explains_most_of_it() -> None:
    random = np.random.default_rng(2)
    x, v = random.uniform(-1.0, 1.0, size=(2, 20_000))
    force = 0.5 * x**3 + random.normal(0.0, 0.03, x.size)
    assert binned(x, force)[3] > 0.9 and binned(v, force)[3] < 0.02


def test_a_variable_that_stands_still_has_one_average() -> None:
    at, mean, _, share = binned(np.full(500, 0.3), np.linspace(0.0, 1.0, 500))
    np.testing.assert_allclose((at, mean), ([0.3], [0.5]))
    assert share < 1e-12


def test_a_model_that_is_lost_says_nothing_of_the_motion() -> None:
    seen = recorded(duration=12.0)
    nothing = np.empty((seen.time.size, 0))
    lost = 3.0 * np.sin(2.0 * seen.time)[:, None]
    at = along(seen, Motion(lost, 2.0 * lost, -4.0 * lost, nothing, nothing), site_of(plant(), "x1"))
    left = np.stack([at.x, at.v], axis=1) - seen.measured
    assert np.all(np.std(left, axis=0) < 1.2 * np.array(NOISE))


def test_samples_around_the_starts_of_free_runs_judge_no_curve() -> None:
    runs = Windows(np.array([0, 500, 1000]), np.zeros((3, 2)), 1.0)
    inside = apart_from_starts(runs, 1500)
    assert inside.size > 1300
    assert np.abs(inside[:, None] - runs.start).min() >= LIKELY_APART_SAMPLES
    assert apart_from_starts(Windows(np.arange(0, 1500, 20), np.zeros((75, 2)), 0.1), 1500).size == 1500
