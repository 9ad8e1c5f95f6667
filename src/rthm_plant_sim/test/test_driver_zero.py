"""What a driver subtracts from the readings of its device."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rthm_core.spec import apply, shipped_spec
from rthm_plant_sim.driver.device import Layout, Reading
from rthm_plant_sim.driver.zero import Zero

SPEC = apply(shipped_spec(), {"zero": {"position": [0.02], "motor": [0.3], "force": [5.0]}})


def test_the_zero_of_the_spec_is_subtracted_from_every_reading() -> None:
    position, velocity, effort = Layout(SPEC).values(Reading(0.12, 0.4, 0.35, 7.0)).tolist()
    np.testing.assert_allclose(position, [0.1, 0.05], atol=1e-15)
    assert velocity[0] == 0.4 and math.isnan(velocity[1])
    assert math.isnan(effort[0]) and effort[1] == 2.0


def test_another_zero_is_taken_for_one_kind_of_sensor() -> None:
    zero = Zero(SPEC)
    assert zero.taken({"force": [1.0]}) == ""
    assert zero.readings[2].tolist() == [0.0, 1.0]
    assert zero.motor.tolist() == [0.3]


@pytest.mark.parametrize("values", [[1.0, 2.0], [], [float("nan")]])
def test_a_zero_of_another_size_changes_nothing(values: list[float]) -> None:
    zero = Zero(SPEC)
    assert "must be 1 finite numbers" in zero.taken({"motor": [0.0], "force": values})
    assert zero.motor.tolist() == [0.3]
    assert "must be 0 finite" in zero.taken({"colour": [1.0]})
