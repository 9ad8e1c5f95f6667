"""Samples lie on the grid whenever readings are made, and are true at their stamps."""

from __future__ import annotations

import numpy as np

from rthm_core.spec import LimitsSpec
from rthm_plant_sim.driver.grid import MOST_AT_ONCE, Grid, longest_pause

P = 1_200_000
LONGEST = 200 * P


def reading(made: int) -> np.ndarray:
    """What a sensor of something that moves at 1 m/s reads."""
    return np.array([made * 1e-9, np.nan])


def test_a_reading_on_time_is_the_sample_of_its_tick() -> None:
    grid = Grid(P, LONGEST)
    for k in range(3):
        ((stamp, values),) = grid.samples(k * P, k * P + P // 20, reading(k * P + P // 20))
        assert stamp == k * P
        assert values[0] == (k * P + P // 20) * 1e-9
    assert grid.between == 0


def test_ticks_that_went_by_lie_between_the_readings_around_them() -> None:
    grid = Grid(P, LONGEST)
    grid.samples(0, 0, reading(0))
    made = 5 * P + P // 2
    found = grid.samples(5 * P, made, reading(made))
    assert [stamp for stamp, _ in found] == [k * P for k in range(1, 6)]
    np.testing.assert_allclose([values[0] for _, values in found], [stamp * 1e-9 for stamp, _ in found])
    assert all(np.isnan(values[1]) for _, values in found)
    ((stamp, values),) = grid.samples(6 * P, 6 * P, reading(6 * P))
    assert (stamp, values[0]) == (6 * P, 6 * P * 1e-9)
    assert (grid.between, grid.missing) == (5, 0)


def test_over_a_long_pause_no_samples_are_made_up() -> None:
    grid = Grid(P, LONGEST)
    grid.samples(0, 0, reading(0))
    late = (LONGEST // P + 2) * P
    ((stamp, _),) = grid.samples(late, late, reading(late))
    assert stamp == late
    assert (grid.between, grid.missing) == (0, LONGEST // P + 1)


def test_samples_are_made_over_as_long_a_pause_as_a_test_survives() -> None:
    assert longest_pause(LimitsSpec(stale=0.05), P) == 50_000_000
    assert longest_pause(LimitsSpec(stale=60.0), P) == MOST_AT_ONCE * P
    grid = Grid(P, longest_pause(LimitsSpec(stale=0.3), P))
    grid.samples(0, 0, reading(0))
    made = 240 * P
    assert [stamp for stamp, _ in grid.samples(made, made, reading(made))] == [k * P for k in range(1, 241)]
