"""Masses that depend on where a dof is: the equation of Lagrange, from a formula of the mass alone."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rthm_core.effects import load_effects, own, registry
from rthm_core.effects.derivative import derivative
from rthm_core.effects.formula import evaluated, parsed
from rthm_core.engine import sensitivities, simulate
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, read_spec, shipped_spec, spec_from_parameters, write_spec

MASS, STIFFNESS = 2.0, 30.0

FORMULAS = [
    "a * sin(b * x)", "a * (1 + b * cos(x))", "x**3 / (1 + x * x)", "2**x", "x**a", "a - b * x**-2", "1 / x",
    "sqrt(1 + x**2) - exp(-x) * log(2 + x)", "min(x, a, x**2)", "max(a * x, 1 - x)", "tan(x) - (-x)",
    "abs(x - 1) * tanh(x) / atan(x + 3)", "3 - x", "a",
]  # fmt: skip


def lever(mass: str, **numbers: Any) -> dict[str, Any]:
    return {"block": "plant", "kind": "inertia", "dof": "x1", "mass": mass} | numbers


def having(spec: Spec, **effects: dict[str, Any]) -> Spec:
    return apply(spec, {"effects": list(effects)} | effects)


def alone(stiffness: float = STIFFNESS) -> Spec:
    plant = {"dofs": ["x1"], "mass": [MASS], "damping": [0.0], "stiffness": [stiffness]}
    start = {"initial_position": [0.2], "initial_velocity": [0.5]}
    return spec_from_parameters({"plant": plant | start})


@pytest.mark.parametrize("text", FORMULAS)
def test_a_derivative_is_the_limit_of_differences(text: str) -> None:
    numbers, x, h = {"a": 1.3, "b": 0.7}, np.array([0.3, 0.9, 1.7]), 1e-6
    found = ast.unparse(derivative(parsed(text, ("x",)), "x").tree)
    ahead, back = (evaluated(text, numbers, x=x + side * h) for side in (1.0, -1.0))
    np.testing.assert_allclose(
        evaluated(found, numbers, x=x), (ahead - back) / (2.0 * h), atol=1e-8, rtol=1e-8
    )


def test_a_free_dof_keeps_the_energy_that_its_mass_has_where_it_is() -> None:
    """Of all mass M exp(2 b x) the motion is known: ``exp(b x)`` grows steadily."""
    b = 0.8
    run = simulate(having(alone(0.0), one=lever("a * (exp(2 * b * x) - 1)", a=MASS, b=b)), 6.0, 0.01)
    expected = np.log(math.exp(b * 0.2) * (1.0 + b * 0.5 * run.t)) / b
    assert np.abs(run.plant_position[:, 0] - expected).max() < 1e-9


def test_kinetic_energy_of_a_lever_is_part_of_the_energy_that_is_kept() -> None:
    run = simulate(having(alone(), one=lever("a * (1 + b * cos(12 * x))", a=1.5, b=0.8)), 20.0, 0.01)
    x, v = run.plant_position[:, 0], run.plant_velocity[:, 0]
    own = 0.5 * 1.5 * (1.0 + 0.8 * np.cos(12.0 * x)) * v**2
    total = own + 0.5 * MASS * v**2 + 0.5 * STIFFNESS * x**2
    assert np.abs(total - total[0]).max() < 1e-10 * total[0]
    assert np.abs(run.energies["E_effects"] + own - own[0]).max() < 1e-9 * total[0]
    assert np.abs(run.balance_error).max() < 1e-9 * total[0]


def test_a_lever_that_is_as_long_everywhere_is_the_plants_mass() -> None:
    paper = shipped_spec("paper")
    heavier = apply(paper, {"plant.mass": [paper.plant.mass[0] + 0.4]})
    run = simulate(having(paper, one=lever("a", a=0.4)), 3.0, 0.01)
    assert np.abs(run.plant_position - simulate(heavier, 3.0, 0.01).plant_position).max() < 1e-11


@pytest.mark.parametrize("beside", [{}, {"kind": "coulomb_friction", "force": 0.2}])
def test_the_balance_of_a_loop_closes_with_a_mass_that_depends_on_the_way(beside: dict[str, Any]) -> None:
    effects = {"one": lever("a * x**2", a=20.0)}
    if beside:
        effects["rub"] = {"block": "plant", "dof": "x1"} | beside
    run = simulate(having(shipped_spec("paper"), **effects), 10.0, 0.01)
    assert np.ptp(run.plant_position) > 0.01
    assert np.abs(run.balance_error).max() < 1e-9 * run.energies["E_total"].max()


def test_a_lever_between_two_dofs_gives_both_the_same_momentum() -> None:
    section = {
        "dofs": ["x1", "x2"], "mass": [2.0, 0.0, 0.0, 1.0], "damping": [0.0] * 4, "stiffness": [0.0] * 4,
        "initial_position": [0.3, -0.1], "initial_velocity": [0.5, -0.4],
    }  # fmt: skip
    between = lever("a * (2 + cos(5 * x))", a=0.7) | {"relative_to": "x2"}
    run = simulate(having(spec_from_parameters({"plant": section}), one=between), 5.0, 0.01)
    v = run.plant_velocity
    apart, speed = run.plant_position @ [1.0, -1.0], v @ [1.0, -1.0]
    total = 0.5 * v**2 @ [2.0, 1.0] + 0.35 * (2.0 + np.cos(5.0 * apart)) * speed**2
    assert np.abs(v @ [2.0, 1.0] - 0.6).max() < 1e-10
    assert np.abs(total - total[0]).max() < 1e-9 * total[0]


def test_sensitivities_are_those_of_neighbours() -> None:
    spec = having(shipped_spec("paper"), one=lever("a * (1 + b * x)", a=0.3, b=2.0))
    found = sensitivities(spec, 1.0, ["one.a"], energies=False)
    low, high = (simulate(apply(spec, {"one.a": 0.3 + by}), 1.0, energies=False) for by in (-1e-4, 1e-4))
    expected = (high.plant_position - low.plant_position) / 2e-4
    assert not found.tangents and np.abs(expected).max() > 1e-3
    assert np.abs(found.by_parameter["one.a"].plant_position - expected).max() < 1e-6


OWN = """
import math
from rthm_core.effects import EffectParameter, PlantLaw, register

@register
class OwnLever(PlantLaw):
    kind = "own_lever"
    blocks = ("plant",)
    parameters = {"a": EffectParameter("kg", "mass at x = 0"), "b": EffectParameter("1/m", "growth")}
    words = "the lever of {dof} has {a}"
    depends_on = ("a", "x", "v")

    @staticmethod
    def inertia(x, v, z, t, p, mode):
        return p[0] * math.exp(p[1] * x)

    @staticmethod
    def force(x, v, z, t, p, mode):
        return -0.5 * p[0] * p[1] * math.exp(p[1] * x) * v * v
"""


@pytest.fixture
def as_before() -> Iterator[None]:
    """Forget what a test declares."""
    before = set(registry.declared())
    yield
    registry.forget(one for one in registry.declared() if one not in before)
    own._LOADED.clear()


@pytest.mark.usefixtures("as_before")
def test_a_law_in_python_that_says_both_its_forces_is_the_formula(tmp_path: Path) -> None:
    file = tmp_path / "own_lever.py"
    file.write_text(OWN, encoding="utf-8")
    load_effects([file])
    law = {"block": "plant", "kind": "own_lever", "dof": "x1", "a": 0.4, "b": 3.0}
    written = lever("a * exp(b * x)", a=0.4, b=3.0)
    paper = shipped_spec("paper")
    one, other = (simulate(having(paper, one=some), 5.0, 0.01) for some in (law, written))
    assert np.abs(one.plant_position - other.plant_position).max() < 1e-11
    assert np.abs(one.energies["E_effects"] - other.energies["E_effects"]).max() < 1e-11


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        ({"one.mass": "a * (1 + b * (x < 0))"}, "a mass that jumps with the position"),
        ({"one.mass": "a * sign(x)"}, "a mass that jumps with the position"),
        ({"one.mass": "a * v"}, "v is unknown"),
        ({"one.a": -2.1}, r"one\.a is -2\.1, .* what leaves the plant is less than its mass"),
    ],
)
def test_a_mass_that_cannot_be_is_refused(changed: dict[str, Any], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        apply(having(alone(), one=lever("a * cos(b * x)", a=0.5, b=1.0)), changed)


def test_a_mass_without_numbers_that_takes_more_than_there_is_is_refused() -> None:
    with pytest.raises(InputError, match=r"one\.mass is '-60 \* x\*\*2', .* less than its mass"):
        having(alone(), one=lever("-60 * x**2"))


def test_a_file_keeps_a_mass_and_what_is_uncertain_of_it() -> None:
    spec = having(alone(), one=lever("a * cos(b * x)", a=0.5, b=1.0, uncertainty={"a": 0.1}))
    assert read_spec(write_spec(spec)) == spec
