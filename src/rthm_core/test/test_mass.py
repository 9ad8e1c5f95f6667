"""Laws of inertia: what joins a dof or leaves it is accelerated, or no longer is, and adds no thrust."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rthm_core.compiled import compiled
from rthm_core.effects.guess import instants
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.physical.advance import present_rate
from rthm_core.physical.side import build
from rthm_core.spec import Spec, apply, shipped_spec, spec_from_parameters

MASS, STIFFNESS = 2.0, 30.0


def joining(change: float, at: float, within: float = 0.0, dof: str = "x1") -> dict[str, Any]:
    return {
        "block": "plant",
        "kind": "mass_change",
        "dof": dof,
        "change": change,
        "at": at,
        "within": within,
    }


def having(spec: Spec, **effects: dict[str, Any]) -> Spec:
    return apply(spec, {"effects": list(effects)} | effects)


def alone(mass: float = MASS, damping: float = 0.0) -> Spec:
    plant = {"dofs": ["x1"], "mass": [mass], "damping": [damping], "stiffness": [STIFFNESS]}
    start = {"initial_position": [0.2], "initial_velocity": [0.5]}
    return spec_from_parameters({"plant": plant | start})


def test_a_mass_that_joined_before_the_test_is_the_plants() -> None:
    paper = shipped_spec("paper")
    heavier = apply(paper, {"plant.mass": [paper.plant.mass[0] + 0.4]})
    with_more = simulate(having(paper, more=joining(0.4, 0.0)), 3.0, 0.01)
    assert np.abs(with_more.plant_position - simulate(heavier, 3.0, 0.01).plant_position).max() < 1e-11


@pytest.mark.parametrize("change", [1.1, -0.7])
def test_a_free_swing_goes_on_from_where_it_is_when_mass_joins_or_leaves(change: float) -> None:
    at = 1.2345678
    run = simulate(having(alone(), some=joining(change, at)), 6.0, 0.01)
    t = run.t

    def swing(mass: float, x: float, v: float, time: np.ndarray) -> np.ndarray:
        w = np.sqrt(STIFFNESS / mass)
        return np.stack([x * np.cos(w * time) + v / w * np.sin(w * time),
                         v * np.cos(w * time) - w * x * np.sin(w * time)])  # fmt: skip

    there = swing(MASS, 0.2, 0.5, np.array(at))
    expected = np.where(t < at, swing(MASS, 0.2, 0.5, t), swing(MASS + change, *there, t - at))
    assert np.abs(run.plant_position[:, 0] - expected[0]).max() < 1e-10
    assert np.abs(run.plant_velocity[:, 0] - expected[1]).max() < 1e-10


def test_momentum_without_forces_stays_with_what_moves() -> None:
    """What joins had the velocity of the dof: it moves on unchanged."""
    free = apply(alone(), {"plant.stiffness": [0.0]})
    run = simulate(having(free, some=joining(0.8, 0.5, 1.0)), 3.0, 0.01)
    assert np.abs(run.plant_velocity - 0.5).max() < 1e-13


def test_a_mass_that_grows_is_a_change_that_does_not_end() -> None:
    growing = {"block": "plant", "kind": "growing_mass", "dof": "x1", "rate": 0.1, "at": 0.5}
    one = simulate(having(alone(), some=growing), 3.0, 0.01)
    other = simulate(having(alone(), some=joining(0.4, 0.5, 4.0)), 3.0, 0.01)
    assert np.abs(one.plant_position - other.plant_position).max() < 1e-11


@compiled
def _rate(physical: Any, dy: Any) -> None:
    present_rate(physical, dy)


def test_forces_accelerate_all_mass_of_dofs_that_are_coupled() -> None:
    mass, stiffness = np.array([[2.0, 0.3], [0.3, 1.0]]), np.array([[30.0, -4.0], [-4.0, 8.0]])
    section = {
        "dofs": ["x1", "x2"],
        "mass": mass.ravel().tolist(),
        "damping": [0.0] * 4,
        "stiffness": stiffness.ravel().tolist(),
        "initial_position": [0.2, -0.1],
        "initial_velocity": [0.0, 0.0],
    }
    plant = spec_from_parameters({"plant": section})
    between = joining(0.7, 0.0) | {"relative_to": "x2"}
    effects = {"one": joining(-0.5, 0.0), "other": joining(0.4, 0.0, dof="x2"), "apart": between}
    physical = build(having(plant, **effects))
    physical.state.modes[:] = 2
    dy = np.zeros(4)
    _rate(physical, dy)
    apart = np.outer([1.0, -1.0], [1.0, -1.0])
    expected = np.linalg.solve(mass + np.diag([-0.5, 0.4]) + 0.7 * apart, -stiffness @ np.array([0.2, -0.1]))
    np.testing.assert_allclose(dy[2:], expected, rtol=1e-13)


def test_a_dof_that_sticks_is_held_whatever_its_mass_and_slides_by_all_of_it() -> None:
    friction = {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.9}
    changed = simulate(having(alone(), some=joining(1.0, 0.0), rub=friction), 6.0, 0.01)
    heavier = simulate(having(alone(MASS + 1.0), rub=friction), 6.0, 0.01)
    assert np.abs(changed.plant_position - heavier.plant_position).max() < 1e-10
    assert changed.plant_velocity[-1] == 0.0


def test_more_than_there_is_cannot_leave() -> None:
    with pytest.raises(InputError, match=r"some\.change is -2\.0, but must be such that .* its mass"):
        having(alone(), some=joining(-2.0, 1.0))
    with pytest.raises(InputError, match=r"other\.change|some\.change"):
        having(alone(), some=joining(-1.2, 1.0), other=joining(-1.2, 2.0))
    assert having(alone(), some=joining(-1.2, 2.0), other=joining(1.2, 1.0)).effects
    leak = {"block": "plant", "kind": "growing_mass", "dof": "x1", "rate": -0.5}
    assert np.isfinite(simulate(having(alone(), leak=leak), 3.9, 0.01).plant_position).all()
    with pytest.raises(InputError, match="duration 5 s is not allowed"):
        simulate(having(alone(), leak=leak), 5.0, 0.01)


def test_fits_begin_where_the_motion_is_and_after_it() -> None:
    time = np.linspace(0.0, 60.0, 6001)
    steady = instants(time, np.sin(40.0 * time))
    np.testing.assert_allclose(np.diff(steady), 5.0, atol=0.1)
    decaying = instants(time, np.exp(-time) * np.sin(40.0 * time))
    assert (decaying[0], decaying[-1]) == (0.0, 60.0) and np.all(np.diff(decaying) > 0.0)
    assert np.count_nonzero(decaying < 2.0) >= 6 and np.count_nonzero(decaying > 2.0) >= 6
    np.testing.assert_allclose(np.diff(instants(time, np.zeros(6001))), 5.0)
