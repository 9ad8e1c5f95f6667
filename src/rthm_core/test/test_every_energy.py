"""The energy balance closes for every kind of effect, from small to dominating."""

import numpy as np
import pytest
from every_kind import LOOP, SIZES, having, named, places

from rthm_core.engine import simulate
from rthm_core.spec import apply

MOTORS = {"at once": {}, "slow": {"actuator.motor_poles": [400.0, 2000.0]}}
CLOSED = 1e-9
"""Largest error of the balance, over the largest energy."""

SAID_OTHERWISE = ("numerical", "wrong_parameter")
"""What energy is counted on are the spec's bodies: a numerical side that computes with other ones does work
that no term has."""


def left_open(place, size, motor="at once", seed=5):
    """Error of the balance over the largest energy."""
    found = simulate(having(apply(LOOP, MOTORS[motor]), *place, size, seed), 3.0, 0.01)
    assert np.isfinite(found.plant_position).all()
    return np.abs(found.balance_error).max() / found.energies["E_total"].max()


@pytest.mark.parametrize("place", [one for one in places() if one != SAID_OTHERWISE], ids=named)
def test_energy_closes(place):
    for size in SIZES:
        assert left_open(place, size) < CLOSED, size


@pytest.mark.parametrize("place", places("plant", "wire", "motor"), ids=named)
def test_energy_closes_behind_a_slow_motor(place):
    assert left_open(place, "middling", "slow") < CLOSED


def test_a_numerical_side_that_computes_with_other_bodies_leaves_its_work_open():
    small, large = (left_open(SAID_OTHERWISE, size) for size in ("small", "dominating"))
    assert 1e-4 < small < large


@pytest.mark.long
@pytest.mark.parametrize("place", [one for one in places() if one != SAID_OTHERWISE], ids=named)
@pytest.mark.parametrize("motor", MOTORS)
def test_energy_closes_at_many_amounts(place, motor):
    for seed in range(10):
        for size in SIZES:
            assert left_open(place, size, motor, seed) < CLOSED, (size, seed)
