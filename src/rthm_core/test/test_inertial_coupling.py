"""Masses that couple two dofs by their positions: a pendulum on a cart, a double and a triple pendulum."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

from rthm_core.compiled import compiled
from rthm_core.engine import sensitivities, simulate
from rthm_core.errors import InputError
from rthm_core.physical.advance import present_rate
from rthm_core.physical.side import build
from rthm_core.spec import Spec, apply, read_spec, shipped_spec, spec_from_parameters, write_spec

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "add-an-effect.md"
GRAVITY = 9.81
Rate = Callable[[float, np.ndarray], np.ndarray]


def plant(mass: list[float], position: list[float], velocity: list[float], **more: list[float]) -> Spec:
    """A plant of uncoupled masses, at first without springs and dampers."""
    n, zero = len(mass), [0.0] * len(mass) ** 2
    section: dict[str, Any] = {"dofs": [f"x{i + 1}" for i in range(n)], "damping": zero, "stiffness": zero}
    section |= {"mass": np.diag(mass).ravel().tolist()} | more
    return spec_from_parameters(
        {"plant": section | {"initial_position": position, "initial_velocity": velocity}}
    )


def coupling(mass: str, dof: str = "x1", relative_to: str = "x2", **numbers: Any) -> dict[str, Any]:
    kind = {"block": "plant", "kind": "inertial_coupling", "dof": dof, "relative_to": relative_to}
    return kind | {"mass": mass} | numbers


def weight(force: str, dof: str, **numbers: float) -> dict[str, Any]:
    return {"block": "plant", "kind": "formula", "dof": dof, "force": force} | numbers


def having(spec: Spec, **effects: dict[str, Any]) -> Spec:
    return apply(spec, {"effects": list(effects)} | effects)


CART, BOB, ROD = 1.2, 0.4, 0.6
"""Masses of a cart and of a bob, kg, and length of the massless rod between them, m."""

POLE = coupling("a * cos(y)", a=BOB * ROD)


def cart_pole() -> Spec:
    """A pendulum that hangs from a cart; x1 is the way of the cart, x2 the angle of the rod."""
    free = plant([CART + BOB, BOB * ROD**2], [0.1, 1.9], [0.3, -1.0])
    return having(free, pole=POLE, hanging=weight("-a * sin(x)", "x2", a=BOB * GRAVITY * ROD))


def cart_pole_rate(t: float, y: np.ndarray) -> np.ndarray:
    """``(M + m sin^2) a = m sin (l w^2 + g cos)``, ``l alpha = -a cos - g sin``."""
    _, angle, v, w = y
    s, c = math.sin(angle), math.cos(angle)
    a = BOB * s * (ROD * w**2 + GRAVITY * c) / (CART + BOB * s**2)
    return np.array([v, w, a, (-a * c - GRAVITY * s) / ROD])


MASSES, LENGTHS = (1.3, 0.7), (0.8, 0.5)
"""Of the upper and of the lower bob of a double pendulum, kg, and of the rods above them, m."""


def double_pendulum() -> Spec:
    """Both angles from the vertical."""
    (m1, m2), (l1, l2) = MASSES, LENGTHS
    free = plant([(m1 + m2) * l1**2, m2 * l2**2], [1.1, -0.7], [0.5, 1.5])
    weights = {
        "upper": weight("-a * sin(x)", "x1", a=(m1 + m2) * GRAVITY * l1),
        "lower": weight("-a * sin(x)", "x2", a=m2 * GRAVITY * l2),
    }
    return having(free, arms=coupling("a * b * c * cos(x - y)", a=m2, b=l1, c=l2), **weights)


def double_pendulum_rate(t: float, y: np.ndarray) -> np.ndarray:
    """Solved for both accelerations, as textbooks print them."""
    (m1, m2), (l1, l2), g = MASSES, LENGTHS, GRAVITY
    one, two, v, w = y
    d, whole = one - two, 2.0 * m1 + m2
    below = whole - m2 * math.cos(2.0 * d)
    a = -g * whole * math.sin(one) - m2 * g * math.sin(one - 2.0 * two)
    a -= 2.0 * math.sin(d) * m2 * (w**2 * l2 + v**2 * l1 * math.cos(d))
    b = v**2 * l1 * (m1 + m2) + g * (m1 + m2) * math.cos(one) + w**2 * l2 * m2 * math.cos(d)
    return np.array([v, w, a / (l1 * below), 2.0 * math.sin(d) * b / (l2 * below)])


@pytest.mark.parametrize(
    ("spec", "rate"),
    [(cart_pole(), cart_pole_rate), (double_pendulum(), double_pendulum_rate)],
    ids=["cart and pole", "double pendulum"],
)
def test_a_motion_is_that_of_the_textbook_and_its_balance_closes(spec: Spec, rate: Rate) -> None:
    run = simulate(spec, 5.0, 0.01)
    start = [*spec.plant.initial_position, *spec.plant.initial_velocity]
    found = solve_ivp(rate, (0.0, 5.0), start, method="DOP853", t_eval=run.t, rtol=1e-11, atol=1e-12).y.T
    assert np.abs(run.plant_position - found[:, :2]).max() < 1e-7
    assert np.abs(run.plant_velocity - found[:, 2:]).max() < 1e-6
    assert np.abs(run.balance_error).max() < 1e-9 * run.energies["E_total"].max()


def on_springs(**more: dict[str, Any]) -> Spec:
    """Two dofs on springs, the first far lighter than the second, whose coupling turns with both."""
    stiffness, damping = [30.0, -4.0, -4.0, 8.0], [0.2, 0.0, 0.0, 0.1]
    free = plant([0.5, 2.0], [0.2, -0.1], [0.5, -0.4], stiffness=stiffness, damping=damping)
    return having(free, one=coupling("a * cos(3 * x - 2 * y)", a=0.8), **more)


def test_a_pendulum_on_a_cart_is_as_the_page_writes_it() -> None:
    block = next(one for one in PAGE.read_text(encoding="utf-8").split("```") if "inertial_coupling" in one)
    section = yaml.safe_load(block.removeprefix("yaml"))
    spec = apply(plant([CART + BOB, BOB * ROD**2], [0.1, 1.9], [0.3, -1.0]), section)
    assert spec.effects[0].parameters == pytest.approx(cart_pole().effects[0].parameters)
    assert spec.effects[1].numbers == pytest.approx(cart_pole().effects[1].numbers)


def test_kinetic_energy_of_a_coupling_is_part_of_what_effects_hold() -> None:
    run = simulate(on_springs(), 8.0, 0.01)
    (x, y), (v, w) = run.plant_position.T, run.plant_velocity.T
    own = 0.8 * np.cos(3.0 * x - 2.0 * y) * v * w
    assert np.ptp(own) > 0.3
    assert np.abs(run.energies["E_effects"] + own - own[0]).max() < 1e-9
    assert np.abs(run.balance_error).max() < 1e-9 * run.energies["E_total"].max()


def test_which_of_two_dofs_is_said_to_be_relative_to_the_other_changes_nothing() -> None:
    other = apply(on_springs(), {"one": coupling("a * cos(3 * y - 2 * x)", "x2", "x1", a=0.8)})
    one, two = (simulate(spec, 3.0, 0.01, energies=False) for spec in (on_springs(), other))
    assert np.abs(one.plant_position - two.plant_position).max() < 1e-12


def test_a_coupling_that_is_the_same_everywhere_is_an_entry_of_the_mass() -> None:
    spec = shipped_spec("three_mass")
    mass = [1.2, 0.3, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0, 0.8]
    found = simulate(having(spec, one=coupling("a", a=0.3)), 2.0, 0.01)
    expected = simulate(apply(spec, {"plant.mass": mass}), 2.0, 0.01)
    assert np.abs(found.plant_position - expected.plant_position).max() < 1e-10


@pytest.mark.parametrize("system", ["hybrid", "ideal"])
def test_the_balance_of_a_loop_closes_with_a_coupling_and_with_friction(system: str) -> None:
    rub = {"block": "plant", "kind": "coulomb_friction", "dof": "x2", "force": 0.1}
    spec = having(shipped_spec("three_mass"), one=coupling("a * x * y", a=4.0), rub=rub)
    run = simulate(spec, 5.0, 0.01, system)  # type: ignore[arg-type]
    assert np.abs(run.balance_error).max() < 1e-9 * run.energies["E_total"].max()


def test_a_dof_that_sticks_is_held_against_what_couples_it() -> None:
    """A cart that does not move is where a pendulum hangs, and energy is kept."""
    rub = {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 50.0}
    pendulum = apply(cart_pole(), {"plant.initial_velocity": [0.0, -1.0]})
    run = simulate(apply(pendulum, {"effects": ["pole", "hanging", "rub"], "rub": rub}), 4.0, 0.01)
    (_, angle), (_, w) = run.plant_position.T, run.plant_velocity.T
    total = 0.5 * BOB * (ROD * w) ** 2 - BOB * GRAVITY * ROD * np.cos(angle)
    assert np.ptp(run.plant_position[:, 0]) == 0.0
    assert np.abs(total - total[0]).max() < 1e-9


@compiled
def _rate(physical: Any, dy: Any) -> None:
    present_rate(physical, dy)


def test_couplings_of_three_dofs_are_solved_together() -> None:
    """Of a triple pendulum, two couplings without the third leave no positive definite mass."""
    whole = np.array([[3.0, 2.0, 1.0], [2.0, 2.0, 1.0], [1.0, 1.0, 1.0]])
    pairs = {"a12": ("x1", "x2", 2.0), "a13": ("x1", "x3", 1.0), "a23": ("x2", "x3", 1.0)}
    arms = {name: coupling("a * cos(x - y)", i, j, a=a) for name, (i, j, a) in pairs.items()}
    stiffness = np.diag([3.0, 5.0, 2.0])
    free = plant([3.0, 2.0, 1.0], [0.4, 0.4, 0.4], [0.0] * 3, stiffness=stiffness.ravel().tolist())
    with pytest.raises(InputError, match="positive definite"):
        having(free, **{name: arms[name] for name in ("a12", "a13")})
    dy = np.zeros(6)
    _rate(build(having(free, **arms)), dy)
    np.testing.assert_allclose(dy[3:], np.linalg.solve(whole, -stiffness @ np.full(3, 0.4)), rtol=1e-12)


def test_sensitivities_are_those_of_neighbours() -> None:
    spec = having(shipped_spec("three_mass"), one=coupling("a * (1 + x * y)", a=0.3))
    found = sensitivities(spec, 1.0, ["one.a"], energies=False)
    low, high = (simulate(apply(spec, {"one.a": 0.3 + by}), 1.0, energies=False) for by in (-1e-4, 1e-4))
    expected = (high.plant_position - low.plant_position) / 2e-4
    assert not found.tangents and np.abs(expected).max() > 1e-3
    assert np.abs(found.by_parameter["one.a"].plant_position - expected).max() < 1e-6


def test_a_motion_to_where_the_mass_is_not_positive_definite_is_no_number_from_there_on() -> None:
    free = plant([1.0, 1.0], [0.0, 0.0], [1.0, 0.1])
    run = simulate(having(free, one=coupling("a * x", a=0.5)), 4.0, 0.01, energies=False)
    known = np.isfinite(run.plant_position[:, 0])
    assert known[0] and not known[-1]
    assert 0.5 * run.plant_position[known, 0].max() < 1.0


WITHOUT = {key: value for key, value in POLE.items() if key != "relative_to"}


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"pole.mass": "a * (x < y)"}, "a mass that jumps with the position"),
        ({"pole.mass": "a * sign(y)"}, "a mass that jumps with the position"),
        ({"pole.mass": "a * cos(v)"}, "v is unknown"),
        ({"pole.a": 2.0}, r"pole\.a is 2\.0, .* mass matrix of the plant is positive definite"),
        ({"pole.mass": "a / (x - 0.1)"}, "mass matrix of the plant is positive definite"),
        (
            {"pole.relative_to": None},
            "relative_to is missing, but must be one of x2; say which dof x1",
        ),
        ({"pole.relative_to": "x1"}, r"pole\.relative_to is 'x1', but must be one of x2"),
    ],
)
def test_a_coupling_that_cannot_be_is_refused(changed: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        apply(cart_pole(), changed)


def test_a_plant_of_one_dof_has_no_coupling() -> None:
    with pytest.raises(InputError, match="another dof, and the plant has only one"):
        having(plant([1.0], [0.0], [0.0]), one=WITHOUT)


def test_what_leaves_a_plant_is_told_before_what_couples_it() -> None:
    lever = {"block": "plant", "kind": "inertia", "dof": "x1", "mass": "a", "a": -3.0}
    with pytest.raises(InputError, match=r"lever\.a is -3\.0, .* less than its mass"):
        apply(cart_pole(), {"effects": ["pole", "hanging", "lever"], "lever": lever})


def test_a_file_keeps_a_coupling_and_what_is_uncertain_of_it() -> None:
    spec = apply(cart_pole(), {"pole": POLE | {"uncertainty": {"a": 0.1}}})
    assert read_spec(write_spec(spec)) == spec
    assert spec.effects[0].law.describe("plant", spec.effects[0].place, spec.effects[0].parameters) == (
        "the mass a * cos(y) couples the accelerations of x1 relative to x2"
    )
