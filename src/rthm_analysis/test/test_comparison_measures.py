"""The measures of a comparison have the values that are worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.comparison.lateness import FEWEST, lateness
from rthm_analysis.comparison.measures import (
    DEFINITIONS,
    frequency_evaluation,
    peak_error,
    tracking_indicator,
)
from rthm_analysis.comparison.motion import Pair
from rthm_analysis.comparison.tracking import tracking

TIME = np.arange(0.0, 20.0, 0.001)


def decaying(t: np.ndarray) -> np.ndarray:
    """A motion with two frequencies that fades, from 0.5 m."""
    return np.exp(-0.05 * t) * (0.4 * np.cos(2.4 * t) + 0.1 * np.cos(4.1 * t))


def test_the_measures_of_three_samples_are_those_of_a_calculation_on_paper() -> None:
    wanted, got = np.array([1.0, 2.0, -2.0]), np.array([1.0, 2.3, -1.6])
    found = tracking("a1.command", "a1.motor", "m", Pair(np.array([0.0, 0.1, 0.2]), wanted, got))
    assert found.nrmse == pytest.approx(np.sqrt((0.3**2 + 0.4**2) / 9.0))
    assert found.peak == pytest.approx(0.4 / 2.0)
    assert np.isnan(found.delay)
    # A = 1.5*1.3 + 0*(-3.9) = 1.95; TA = 1.65*1 + 0.35*(-4) = 0.25
    assert found.indicator == pytest.approx(0.5 * (1.95 - 0.25))


def test_a_peak_error_of_what_should_be_at_rest_is_not_known() -> None:
    assert np.isnan(peak_error(np.zeros(3), np.ones(3)))


@pytest.mark.parametrize(("gain", "delay"), [(1.0, 0.01), (0.7, 0.0314), (1.2, -0.005), (1.0, 0.0)])
def test_the_frequency_evaluation_index_finds_gain_and_delay(gain: float, delay: float) -> None:
    wanted, got = (a * np.sin(5.0 * (TIME - d)) for a, d in ((0.02, 0.0), (0.02 * gain, delay)))
    found = frequency_evaluation(0.001, wanted, got)
    assert found.amplitude == pytest.approx(gain, rel=1e-4)
    assert found.delay == pytest.approx(delay, abs=2e-5)
    assert found.frequency == pytest.approx(5.0 / (2.0 * np.pi), rel=0.01)


def test_the_index_of_a_motion_that_fades_is_that_of_its_delay() -> None:
    found = frequency_evaluation(0.001, decaying(TIME), 0.9 * decaying(TIME - 0.012))
    assert found.amplitude == pytest.approx(0.9, rel=0.005)
    assert found.delay == pytest.approx(0.012, abs=2e-4)


def test_an_index_of_what_stands_still_is_not_known() -> None:
    assert np.isnan(frequency_evaluation(0.001, np.zeros(100), np.ones(100))).all()


def test_the_tracking_indicator_grows_by_its_area_with_every_cycle_that_is_late() -> None:
    cycles = np.linspace(0.0, 6.0 * np.pi, 60001)
    late = tracking_indicator(2.0 * np.sin(cycles), 2.0 * np.sin(cycles - 0.2))
    assert late == pytest.approx(3.0 * np.pi * 4.0 * np.sin(0.2), rel=1e-4)
    assert tracking_indicator(np.sin(cycles), np.sin(cycles + 0.2)) < 0.0
    assert tracking_indicator(np.sin(cycles), 0.5 * np.sin(cycles)) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("delay", [0.0, 0.00037, 0.0123, 0.2, -0.0456])
def test_a_delay_is_found_between_the_samples(delay: float) -> None:
    time = np.arange(0.0, 20.0, 0.0012)
    found = lateness(time, decaying(time), 0.8 * decaying(time - delay) + 0.01)
    assert found.delay.value == pytest.approx(delay, abs=1e-6)
    assert found.gain.value == pytest.approx(0.8, abs=1e-5)
    assert found.rest < 1e-5


def test_the_uncertainty_of_a_delay_is_that_of_its_spread() -> None:
    time, random = np.arange(0.0, 20.0, 0.004), np.random.default_rng(3)
    one, late = decaying(time), decaying(time - 0.01)
    found = [lateness(time, one, late + random.normal(0.0, 0.01, time.size)) for _ in range(40)]
    spread = np.std([each.delay.value - 0.01 for each in found])
    told = np.mean([each.delay.std for each in found])
    assert 0.6 < told / spread < 1.8
    assert abs(np.mean([each.delay.value for each in found]) - 0.01) < 5e-4


def test_signals_that_tell_no_delay_give_none() -> None:
    few, many = np.linspace(0.0, 1.0, FEWEST - 1), np.linspace(0.0, 1.0, FEWEST)
    assert np.isnan(lateness(few, np.sin(few), np.sin(few - 0.1)).delay.value)
    assert np.isnan(lateness(many, np.sin(many), np.ones(FEWEST)).delay.value)
    assert np.isnan(lateness(many, np.sin(many), 1e200 * np.sin(many)).delay.value)


def test_every_measure_says_what_it_is_and_where_it_is_from() -> None:
    assert {"NRMS", "J1", "J2", "J3", "J4-J6", "J7-J9", "FEI", "TI"} <= DEFINITIONS.keys()
    assert all(what and source for what, source in DEFINITIONS.values())
